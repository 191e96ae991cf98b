// Optimisation by reinsertion: Bittner, Hapala & Havran 2013, "Fast insertion-based optimization of bounding volume hierarchies" (CGF 32(1)), all nodes in
// parallel as in Meister & Bittner 2018, "Parallel reinsertion for bounding volume hierarchy optimization" (CGF 37(2)). Taking a subtree out frees its parent
// and shrinks the nodes above; putting it in beside another node costs a new parent and the growth of the nodes above. Each round finds, for every node of the
// unchanged tree at once, the place with the greatest gain, by branch and bound: outwards from the node, through the subtree beside each node above it.
//
// Departure: the paper locks the nodes that a move touches; here moves are made one after another, the greatest gain first, and each only if it still gains in
// the tree as it then is. So the sum of areas falls with every move, and the result depends on neither threads nor locks.

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "accel/bvh/reinsertion.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

constexpr std::int32_t kNone = -1;

struct Node {
  Aabb box;
  std::int32_t parent = kNone;
  std::int32_t child[2] = {kNone, kNone};
  std::int32_t source = kNone;  ///< in the tree
  [[nodiscard]] bool leaf() const noexcept { return child[0] == kNone; }
};

struct Move {
  std::int32_t from;
  std::int32_t to = kNone;  ///< the sibling-to-be
  float gain = 0;           ///< in half area
};

Aabb merged(const Aabb& a, const Aabb& b) noexcept {
  Aabb box = a;
  box.grow(b);
  return box;
}

class Reinsertion {
public:
  explicit Reinsertion(const BvhTree& tree) : tree_(tree), nodes_(tree.nodes.size()), seen_(tree.nodes.size(), kNone) {
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(nodes_.size()); ++n) {
      const BvhTree::Node& from = tree.node(n);
      at(n).box = from.box;
      at(n).source = n;
      for (std::int32_t c = 0; c < from.child_count; ++c) {
        at(n).child[c] = from.first + c;
        at(from.first + c).parent = n;
      }
    }
  }

  /// Returns whether anything moved.
  bool round() {
    std::vector<Move> moves(nodes_.size());
    tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, static_cast<std::int32_t>(nodes_.size()), 256), [&](const tbb::blocked_range<std::int32_t>& range) {
      std::vector<Open> open;
      for (std::int32_t n = range.begin(); n < range.end(); ++n) moves[static_cast<std::size_t>(n)] = best_move(n, open);
    });
    std::erase_if(moves, [](const Move& move) { return move.to == kNone; });
    std::sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) { return a.gain != b.gain ? a.gain > b.gain : a.from < b.from; });
    bool moved = false;
    for (const Move& move : moves) moved |= try_move(move);
    return moved;
  }

  [[nodiscard]] BvhTree tree() const {
    BvhTree out{{}, tree_.order};
    out.nodes.reserve(nodes_.size());
    out.nodes.push_back(tree_.node(0));
    std::vector<std::int32_t> source{0};
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(out.nodes.size()); ++n) {
      const Node& node = nodes_[static_cast<std::size_t>(source[static_cast<std::size_t>(n)])];
      if (node.leaf()) {
        out.node(n) = tree_.node(node.source);
        continue;
      }
      out.node(n) = {node.box, static_cast<std::int32_t>(out.nodes.size()), 2, 0};
      for (const std::int32_t c : node.child) {
        out.nodes.push_back({});
        source.push_back(c);
      }
    }
    return depth_first(out);
  }

private:
  struct Open {
    std::int32_t node;
    float gain;  ///< of what happens above the node
  };

  [[nodiscard]] Node& at(std::int32_t n) noexcept { return nodes_[static_cast<std::size_t>(n)]; }
  [[nodiscard]] const Node& at(std::int32_t n) const noexcept { return nodes_[static_cast<std::size_t>(n)]; }
  [[nodiscard]] std::int32_t sibling(std::int32_t n) const noexcept {
    const Node& parent = at(at(n).parent);
    return parent.child[parent.child[0] == n ? 1 : 0];
  }

  /// The root and its children stay.
  [[nodiscard]] bool movable(std::int32_t n) const noexcept { return at(n).parent != kNone && at(at(n).parent).parent != kNone; }

  [[nodiscard]] Move best_move(std::int32_t from, std::vector<Open>& open) const {
    Move best{from};
    if (!movable(from)) return best;
    const Aabb& box = at(from).box;
    const std::int32_t parent = at(from).parent;
    float gain = at(parent).box.half_area();  // the parent goes
    Aabb remaining = at(sibling(from)).box;   // what the node above holds afterwards
    search_below(sibling(from), gain, box, open, best);
    for (std::int32_t below = parent; at(below).parent != kNone; below = at(below).parent) {
      search_below(sibling(below), gain, box, open, best);
      const std::int32_t above = at(below).parent;
      if (at(above).parent == kNone) break;  // the root stays
      remaining.grow(at(sibling(below)).box);
      gain += at(above).box.half_area() - remaining.half_area();
      const float beside_above = gain - at(above).box.half_area();
      if (beside_above > best.gain) best = {from, above, beside_above};
    }
    if (best.to == sibling(from)) best.to = kNone;
    return best;
  }

  /// Looks through the subtree at `top`, where `gain` is what taking `box` out brings. No place below a node can gain more than if its new parent were no
  /// larger than the box itself.
  void search_below(std::int32_t top, float gain, const Aabb& box, std::vector<Open>& open, Move& best) const {
    const float area = box.half_area();
    open.assign(1, {top, gain});
    while (!open.empty()) {
      const Open item = open.back();
      open.pop_back();
      if (!(item.gain - area > best.gain)) continue;
      const Node& node = at(item.node);
      const float common_area = merged(node.box, box).half_area();
      if (item.gain - common_area > best.gain) best = {best.from, item.node, item.gain - common_area};
      if (node.leaf()) continue;
      const float below = item.gain - (common_area - node.box.half_area());
      for (const std::int32_t c : node.child) open.push_back({c, below});
    }
  }

  /// What a move gains in the tree as it is now, in double; not above 0 where it cannot be made.
  [[nodiscard]] double gain_now(const Move& move) {
    const std::int32_t parent = at(move.from).parent;
    if (!movable(move.from) || at(move.to).parent == kNone || move.to == parent || move.to == sibling(move.from)) return 0;
    ++round_of_seen_;
    for (std::int32_t n = at(move.to).parent; n != kNone; n = at(n).parent) {
      if (n == move.from) return 0;  // it has come to lie below
      seen_[static_cast<std::size_t>(n)] = round_of_seen_;
    }
    double gain = double{at(parent).box.half_area()};
    Aabb remaining = at(sibling(move.from)).box, to = at(move.to).box;
    std::int32_t common = at(parent).parent;
    for (std::int32_t below = parent; !seen(common); below = common, common = at(common).parent) {
      remaining.grow(at(sibling(below)).box);
      gain += double{at(common).box.half_area()} - double{remaining.half_area()};
      if (common == move.to) to = remaining;
    }
    gain -= double{merged(to, at(move.from).box).half_area()};
    for (std::int32_t n = at(move.to).parent; n != common && n != parent; n = at(n).parent) {
      gain -= double{merged(at(n).box, at(move.from).box).half_area()} - double{at(n).box.half_area()};
    }
    return gain;
  }

  [[nodiscard]] bool seen(std::int32_t n) const noexcept { return seen_[static_cast<std::size_t>(n)] == round_of_seen_; }

  bool try_move(const Move& move) {
    if (!(gain_now(move) > 0)) return false;
    const std::int32_t parent = at(move.from).parent, grandparent = at(parent).parent;
    replace_child(grandparent, parent, sibling(move.from));
    refit(grandparent);
    replace_child(at(move.to).parent, move.to, parent);
    at(parent).child[0] = move.to;
    at(parent).child[1] = move.from;
    at(move.to).parent = parent;
    refit(parent);
    return true;
  }

  void replace_child(std::int32_t n, std::int32_t old_child, std::int32_t new_child) {
    at(n).child[at(n).child[0] == old_child ? 0 : 1] = new_child;
    at(new_child).parent = n;
  }

  /// Fits the boxes from `first` upwards, until one above it stays as it is.
  void refit(std::int32_t first) {
    for (std::int32_t n = first; n != kNone; n = at(n).parent) {
      const Aabb box = merged(at(at(n).child[0]).box, at(at(n).child[1]).box);
      if (n != first && box.min == at(n).box.min && box.max == at(n).box.max) return;
      at(n).box = box;
    }
  }

  const BvhTree& tree_;
  std::vector<Node> nodes_;
  std::vector<std::int32_t> seen_;  ///< by gain_now(): the number of its call that met the node
  std::int32_t round_of_seen_ = 0;
};

}  // namespace

BvhTree reinserted(const BvhTree& tree, int passes, int threads) {
  if (tree.nodes.empty()) return tree;
  return on_threads(threads, [&] {
    Reinsertion reinsertion(tree);
    for (int pass = 0; pass < passes && reinsertion.round(); ++pass) {
    }
    return reinsertion.tree();
  });
}

}  // namespace raymeter
