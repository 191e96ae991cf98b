#include "accel/octree/octree_flatten.h"

#include <algorithm>
#include <limits>

namespace raymeter {

namespace {

constexpr std::uint32_t kUnseen = 0xFFFFFFFFu;

class Flattener {
public:
  Flattener(const Pools& pools, const OctreeDraft& draft, Octree& tree) : pools_(pools), draft_(draft), tree_(tree) {
    for (std::size_t e = 0; e < draft.entries.size(); ++e) {
      const PrimKind kind = draft.entries[e].kind();
      if (tree.kinds.empty() || tree.kinds.back() != kind) tree.kinds.push_back(kind);
    }
    if (tree.kinds.empty()) tree.kinds.push_back(PrimKind::triangle);  // lists of none
    next_.resize(tree.kinds.size());
  }

  void run() {
    constexpr std::size_t kMost = std::size_t{1} << 27;  // 16 words a node
    if (draft_.nodes.size() > kMost || draft_.refs.size() > std::numeric_limits<std::int32_t>::max() ||
        draft_.leaf_end.size() * tree_.kinds.size() > std::numeric_limits<std::int32_t>::max()) {
      throw Error("budget: an octree of " + std::to_string(draft_.nodes.size()) + " nodes and " + std::to_string(draft_.refs.size()) +
                  " references is too large; expected less than 2^27 and 2^31");
    }
    moved_.assign(draft_.entries.size(), kUnseen);
    tree_.nodes.reserve(draft_.nodes.size());
    tree_.outline.reserve(draft_.nodes.size() * static_cast<std::size_t>(OctreeWords::kOutline));
    tree_.first.reserve(draft_.leaf_end.size() * tree_.kinds.size() + 1);
    tree_.refs.reserve(draft_.refs.size());
    add_list(0);
    tree_.root = number(draft_.root, 0);
    add_nodes();
    tree_.first.push_back(static_cast<std::int32_t>(tree_.refs.size()));
    tree_.pools = reordered(pools_, order_);
    BuildStats& stats = tree_.stats;
    stats.interior_nodes = static_cast<std::int64_t>(tree_.nodes.size());
    stats.references = static_cast<std::int64_t>(tree_.refs.size());
    const auto listing = static_cast<std::int64_t>(draft_.leaf_end.size()) - 1;
    stats.leaves = listing + stats.empty_leaves;
    if (draft_.root == ~0) stats.leaves = stats.empty_leaves = 1;
  }

private:
  /// Nodes that have a number but no place yet, the next one to get its place last.
  struct Waiting {
    std::int32_t draft, parent;
    int child;
  };

  void add_nodes() {
    while (!waiting_.empty()) {
      const Waiting at = waiting_.back();
      waiting_.pop_back();
      const auto self = static_cast<std::int32_t>(tree_.nodes.size());
      if (at.child >= 0) tree_.nodes[static_cast<std::size_t>(at.parent)].child[at.child] = self;
      add_node(draft_.nodes[static_cast<std::size_t>(at.draft)], at, self);
    }
  }

  void add_node(const OctreeDraft::Node& from, const Waiting& at, std::int32_t self) {
    OctreeNode node{{from.split.x, from.split.y, from.split.z}, 0, {}, at.child >= 0 ? at.parent : 0};
    for (int a = 0; a < 6; ++a) tree_.outline.push_back(plane(from.box, a, at));
    for (int c = 0; c < 8; ++c) {
      if (from.child[c] != ~0) continue;
      node.empty |= 1u << c;
      if (exists(from.split, c)) ++tree_.stats.empty_leaves;
    }
    tree_.nodes.push_back(node);
    const std::size_t bottom = waiting_.size();
    for (int c = 0; c < 8; ++c) tree_.nodes.back().child[c] = from.child[c] == ~0 ? ~0 : number(from.child[c], self, c);
    std::reverse(waiting_.begin() + static_cast<std::ptrdiff_t>(bottom), waiting_.end());
  }

  /// A side of a node's cell; infinite where the root has it too, so that there is nothing to be entered beyond it.
  [[nodiscard]] float plane(const Aabb& box, int a, const Waiting& at) const noexcept {
    const glm::length_t axis = a % 3;
    const float own = a < 3 ? box.min[axis] : box.max[axis];
    const Aabb& root = draft_.nodes[static_cast<std::size_t>(draft_.root)].box;
    const bool border = at.child < 0 || own == (a < 3 ? root.min[axis] : root.max[axis]);
    constexpr float kInf = std::numeric_limits<float>::infinity();
    return border ? (a < 3 ? -kInf : kInf) : own;
  }

  [[nodiscard]] static bool exists(const glm::vec3& split, int child) noexcept {
    for (glm::length_t a = 0; a < 3; ++a) {
      if ((child >> a & 1) != 0 && split[a] == std::numeric_limits<float>::infinity()) return false;
    }
    return true;
  }

  /// The link to a draft's node, which is filled in when it gets its place, or leaf.
  std::int32_t number(std::int32_t link, std::int32_t parent, int child = -1) {
    if (link >= 0) {
      waiting_.push_back({link, parent, child});
      return 0;
    }
    return ~(link == ~0 ? 0 : add_list(static_cast<std::size_t>(~link)));
  }

  std::int32_t add_list(std::size_t leaf) {
    const auto number = static_cast<std::int32_t>(tree_.first.size() / tree_.kinds.size());
    std::size_t at = leaf > 0 ? draft_.leaf_end[leaf - 1] : 0;
    for (std::size_t k = 0; k < tree_.kinds.size(); ++k) {
      tree_.first.push_back(static_cast<std::int32_t>(tree_.refs.size()));
      for (; at < draft_.leaf_end[leaf] && draft_.entries[draft_.refs[at]].kind() == tree_.kinds[k]; ++at) {
        std::uint32_t& moved = moved_[draft_.refs[at]];
        if (moved == kUnseen) {
          moved = next_[k]++;
          order_.push_back(draft_.entries[draft_.refs[at]]);
        }
        tree_.refs.push_back(static_cast<std::int32_t>(moved));
      }
    }
    return number;
  }

  const Pools& pools_;
  const OctreeDraft& draft_;
  Octree& tree_;
  std::vector<Waiting> waiting_;
  std::vector<std::uint32_t> moved_;  ///< per entry: its index in the tree's pools
  std::vector<std::uint32_t> next_;   ///< per kind: the next such index
  std::vector<PrimRef> order_;
};

}  // namespace

std::int32_t OctreeDraft::add_node(std::int32_t parent, int child, const glm::vec3& split, const Aabb& box) {
  nodes.push_back({split, box});
  const auto link = static_cast<std::int32_t>(nodes.size() - 1);
  attach(parent, child, link);
  return link;
}

void OctreeDraft::add_leaf(std::int32_t parent, int child, std::span<const std::uint32_t> list) {
  if (list.empty()) return;
  refs.insert(refs.end(), list.begin(), list.end());
  leaf_end.push_back(refs.size());
  attach(parent, child, ~static_cast<std::int32_t>(leaf_end.size() - 1));
}

void OctreeDraft::attach(std::int32_t parent, int child, std::int32_t link) noexcept {
  if (parent < 0)
    root = link;
  else
    nodes[static_cast<std::size_t>(parent)].child[child] = link;
}

void flatten(const Pools& pools, const OctreeDraft& draft, Octree& tree) { Flattener(pools, draft, tree).run(); }

OctreeView Octree::view(const OctreeParams& params) const noexcept {
  OctreeView view{};
  view.pools = pools.view();
  std::copy(box.begin(), box.end(), view.box);
  view.root = root;
  view.depth = static_cast<std::int32_t>(stats.max_depth.value_or(0));
  view.nodes = nodes.data();
  view.outline = outline.data();
  view.first = first.data();
  view.refs = refs.data();
  view.kind_count = static_cast<std::int32_t>(kinds.size());
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    view.kind[k] = kinds[k];
    view.prim_count[k] = static_cast<std::int32_t>(pools.size(kinds[k]));
  }
  std::copy(center.begin(), center.end(), view.center);
  view.reach = reach;
  view.exact = exact;
  view.neighbour = params.tracking == "neighbour";
  view.from_origin = params.start == "origin";
  view.nearest_blocker = params.blocker == "nearest";
  view.mailbox = params.mailbox;
  return view;
}

}  // namespace raymeter
