#include "accel/bvh/flat_tree.h"

#include <algorithm>
#include <array>

#include "accel/volume_links.h"

namespace raymeter {

namespace {

class Flattening {
public:
  Flattening(const BvhTree& tree, FlatTree& flat) : tree_(tree), flat_(flat) {}

  void run() {
    flat_.links.resize(2, volume_link(VolumeLink::kRuns, 0, 0));
    flat_.sources.resize(2);
    if (tree_.nodes.empty()) return;
    flat_.sources[0].node = 0;
    struct Item {
      std::size_t link;
      std::int32_t stack_below;
    };
    std::vector<Item> open{{0, 1}};
    std::int32_t leaves = 0;
    while (!open.empty()) {
      const Item item = open.back();
      open.pop_back();
      const BvhTree::Node& node = tree_.node(flat_.sources[item.link].node);
      if (node.child_count == 0) {
        ++leaves;
        add_leaf(item.link, node);
        continue;
      }
      const std::size_t first = flat_.links.size(), count = static_cast<std::size_t>(node.child_count);
      flat_.links[item.link] = volume_link(VolumeLink::kInner, first, count);
      flat_.links.resize(first + count);
      flat_.sources.resize(first + count);
      // Opening this node puts its children on the stack in its own place.
      const std::int32_t stack_below = item.stack_below + node.child_count - 1;
      flat_.stack_capacity = std::max(flat_.stack_capacity, stack_below);
      for (std::size_t c = count; c-- > 0;) {
        flat_.sources[first + c].node = node.first + static_cast<std::int32_t>(c);
        open.push_back({first + c, stack_below});
      }
    }
    flat_.heap_capacity = std::max(1, leaves);
    find_prims_below();
  }

private:
  void add_leaf(std::size_t link, const BvhTree::Node& node) {
    std::vector<PrimitiveRun> leaf;
    for (std::int32_t i = 0; i < node.prim_count;) {
      const PrimKind kind = prim(node.first + i).kind();
      std::int32_t end = i;
      while (end < node.prim_count && prim(node.first + end).kind() == kind) ++end;
      std::int32_t& next = next_of_kind_[static_cast<std::size_t>(kind)];
      leaf.push_back(primitive_run(kind, next, end - i));
      next += end - i;
      i = end;
    }
    FlatTree::Source& source = flat_.sources[link];
    source.first_prim = static_cast<std::int32_t>(flat_.order.size());
    const auto begin = tree_.order.begin() + node.first;
    flat_.order.insert(flat_.order.end(), begin, begin + node.prim_count);
    source.end_prim = static_cast<std::int32_t>(flat_.order.size());
    flat_.links[link] = link_to(leaf, flat_.runs);
  }

  /// Leaves were reached in order, so that what is below a node is one range; children stand behind their parent.
  void find_prims_below() {
    for (std::size_t i = flat_.links.size(); i-- > 0;) {
      const VolumeLink& link = flat_.links[i];
      if (link.tag() != VolumeLink::kInner) continue;
      flat_.sources[i].first_prim = flat_.sources[static_cast<std::size_t>(link.first)].first_prim;
      flat_.sources[i].end_prim = flat_.sources[static_cast<std::size_t>(link.first + link.count() - 1)].end_prim;
    }
  }

  [[nodiscard]] PrimRef prim(std::int32_t position) const noexcept { return tree_.order[static_cast<std::size_t>(position)]; }

  const BvhTree& tree_;
  FlatTree& flat_;
  std::array<std::int32_t, kPrimKindCount> next_of_kind_{};
};

}  // namespace

FlatTree flatten(const BvhTree& tree) {
  FlatTree flat;
  Flattening(tree, flat).run();
  return flat;
}

}  // namespace raymeter
