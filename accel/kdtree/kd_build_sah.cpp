// The cheapest plane of a cell by the surface area heuristic (MacDonald, Booth 1990), C = traversal_cost + intersection_cost (A_l N_l + A_r N_r) / A, times
// 1 - empty_bonus where a side is empty (Havran 2000; Wald, Havran 2006). Planes stand where references begin or end; references that lie in the plane go to
// the cheaper side, and a plane on the cell's own border may cut those off that lie in it.
//
// Few references are sorted and swept. Many are counted in bins first, which bound from below what any plane in a bin can cost; then the most promising bins
// are swept exactly. So a node takes linear time, and a build O(n log n).

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "accel/kdtree/kd_topology.h"

namespace raymeter {

namespace {

constexpr std::size_t kSorted = 32;             // up to so many references are swept without bins
constexpr std::size_t kParallelBins = 1 << 16;  // from so many on bins are filled by several tasks
constexpr std::size_t kMostBins = 256;
constexpr std::size_t kSweptBins = 4;
constexpr double kInf = std::numeric_limits<double>::infinity();

/// What planes of a cell cost.
class PlaneCost {
public:
  PlaneCost(const Aabb& cell, const KdTreeParams& params) noexcept : params_(params) {
    const glm::dvec3 extent = glm::dvec3(cell.max) - glm::dvec3(cell.min);
    // In scenes without area, all on a line, lengths are to tell.
    const double thickness = 0x1p-20 * std::max({extent.x, extent.y, extent.z});
    for (glm::length_t a = 0; a < 3; ++a) {
      low_[a] = double{cell.min[a]};
      high_[a] = double{cell.max[a]};
      const double u = extent[(a + 1) % 3] + thickness, v = extent[(a + 2) % 3] + thickness;
      around_[a] = u + v;
      end_[a] = u * v + (u + v) * thickness;
    }
    area_ = end_[0] + around_[0] * extent.x;
  }
  [[nodiscard]] bool usable() const noexcept { return area_ > 0 && area_ < kInf; }
  [[nodiscard]] double of_leaf(std::size_t count) const noexcept { return params_.intersection_cost * static_cast<double>(count); }
  /// With areas as of planes at `low` and `high`, which differ for bounds.
  [[nodiscard]] double of_plane(int axis, double low, double high, std::size_t below, std::size_t above) const noexcept {
    const double low_area = end_[axis] + around_[axis] * (low - low_[axis]), high_area = end_[axis] + around_[axis] * (high_[axis] - high);
    const double tests = (low_area * static_cast<double>(below) + high_area * static_cast<double>(above)) / area_;
    return (params_.traversal_cost + params_.intersection_cost * tests) * (below == 0 || above == 0 ? 1 - params_.empty_bonus : 1.0);
  }

private:
  const KdTreeParams& params_;
  glm::dvec3 low_, high_;
  glm::dvec3 around_;  ///< half the girth across an axis
  glm::dvec3 end_;     ///< the area across it
  double area_ = 0;
};

/// The end of a reference, flat, or its beginning, at a coordinate: in the order of both as a number.
class Event {
public:
  enum Kind : std::uint64_t { end, flat, begin };
  Event(float x, Kind kind) noexcept : key_(std::uint64_t{ordered(x + 0.0f)} << 2 | kind) {}  // + 0 turns -0 into +0
  [[nodiscard]] Kind kind() const noexcept { return static_cast<Kind>(key_ & 3); }
  [[nodiscard]] float position() const noexcept {
    const auto bits = static_cast<std::uint32_t>(key_ >> 2);
    return std::bit_cast<float>((bits & kSign) != 0 ? bits ^ kSign : ~bits);
  }
  friend bool operator<(Event a, Event b) noexcept { return a.key_ < b.key_; }

private:
  static constexpr std::uint32_t kSign = 0x80000000u;
  static std::uint32_t ordered(float x) noexcept {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return (bits & kSign) != 0 ? ~bits : bits ^ kSign;
  }
  std::uint64_t key_;
};

struct Best {
  double cost = kInf;
  KdPlane plane;
};

/// Weighs every coordinate of `events`; `below` references begin before them all, `above` do not end before them.
void sweep(std::span<Event> events, int axis, std::size_t below, std::size_t above, const Aabb& cell, const PlaneCost& cost, Best& best) {
  std::sort(events.begin(), events.end());
  const float low = cell.min[axis], high = cell.max[axis];
  const auto weigh = [&](float x, std::size_t count_below, std::size_t count_above, bool flat_below) {
    const double plane_cost = cost.of_plane(axis, double{x}, double{x}, count_below, count_above);
    if (plane_cost < best.cost) best = {plane_cost, {axis, x, flat_below}};
  };
  for (std::size_t i = 0; i < events.size();) {
    const float x = events[i].position();
    std::size_t count[3] = {};
    for (; i < events.size() && events[i].position() == x; ++i) ++count[events[i].kind()];
    const std::size_t flat = count[Event::flat];
    above -= flat + count[Event::end];
    // On the cell's border only those in the plane can be cut off, and something must remain.
    const bool inside = low < x && x < high;
    if (inside || (x == low && low < high && flat > 0 && above > 0)) weigh(x, below + flat, above, true);
    if ((inside && flat > 0) || (x == high && low < high && flat > 0 && below > 0)) weigh(x, below, above + flat, false);
    below += flat + count[Event::begin];
  }
}

void add_events(const SplitReference& reference, int axis, std::vector<Event>& events) {
  const float low = reference.box.min[axis], high = reference.box.max[axis];
  if (low == high) {
    events.emplace_back(low, Event::flat);
    return;
  }
  events.emplace_back(low, Event::begin);
  events.emplace_back(high, Event::end);
}

/// Bins of equal width on the three axes of a cell, and how many references begin and end in each.
struct Bins {
  std::array<std::array<std::uint32_t, kMostBins>, 3> begin{};
  std::array<std::array<std::uint32_t, kMostBins>, 3> end{};
  void add(const Bins& other) noexcept {
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < kMostBins; ++b) {
        begin[a][b] += other.begin[a][b];
        end[a][b] += other.end[a][b];
      }
    }
  }
};

struct Candidate {
  double bound = kInf;  ///< no plane in the bin costs less
  int axis = 0;
  int bin = 0;
  std::size_t below = 0, above = 0;  ///< for sweep()
};

class BinnedSearch {
public:
  BinnedSearch(std::span<const SplitReference> references, const Aabb& cell, const PlaneCost& cost)
      : references_(references), cell_(cell), cost_(cost), bins_(references.size() < 1024 ? 64 : static_cast<int>(kMostBins)) {
    for (glm::length_t a = 0; a < 3; ++a) {
      const double extent = double{cell.max[a]} - double{cell.min[a]};
      scale_[a] = extent > 0 ? bins_ / extent : 0.0;
    }
  }

  [[nodiscard]] Best run() const {
    const std::array<Candidate, kSweptBins> candidates = most_promising(counted());
    std::array<std::vector<Event>, kSweptBins> events;
    for (const SplitReference& reference : references_) {
      for (std::size_t c = 0; c < kSweptBins && candidates[c].bound < kInf; ++c) gather(reference, candidates[c], events[c]);
    }
    Best best;
    for (std::size_t c = 0; c < kSweptBins && candidates[c].bound < best.cost; ++c) {
      sweep(events[c], candidates[c].axis, candidates[c].below, candidates[c].above, cell_, cost_, best);
    }
    return best;
  }

private:
  /// Grows with x, so that a bin holds all events between two coordinates.
  [[nodiscard]] int bin(float x, int axis) const noexcept {
    return std::clamp(static_cast<int>((double{x} - double{cell_.min[axis]}) * scale_[axis]), 0, bins_ - 1);
  }

  [[nodiscard]] Bins counted() const {
    using Range = tbb::blocked_range<std::size_t>;
    const auto count = [&](const Range& range, Bins bins) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
          const auto axis = static_cast<int>(a);
          ++bins.begin[a][static_cast<std::size_t>(bin(references_[i].box.min[axis], axis))];
          ++bins.end[a][static_cast<std::size_t>(bin(references_[i].box.max[axis], axis))];
        }
      }
      return bins;
    };
    const Range all(0, references_.size(), kParallelBins / 4);
    if (references_.size() < kParallelBins) return count(all, Bins());
    return tbb::parallel_reduce(all, Bins(), count, [](Bins a, const Bins& b) {
      a.add(b);
      return a;
    });
  }

  /// The bins of the least bounds, cheapest first.
  [[nodiscard]] std::array<Candidate, kSweptBins> most_promising(const Bins& bins) const {
    std::array<Candidate, kSweptBins> least;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double low = double{cell_.min[axis]}, width = (double{cell_.max[axis]} - low) / bins_;
      std::size_t below = 0, above = references_.size();
      for (int b = 0; b < bins_ && width > 0; ++b) {
        const std::uint32_t begin = bins.begin[a][static_cast<std::size_t>(b)], end = bins.end[a][static_cast<std::size_t>(b)];
        const Candidate candidate{cost_.of_plane(axis, low + b * width, low + (b + 1) * width, below, above - end), axis, b, below, above};
        below += begin;
        above -= end;
        if (begin + end == 0 || !(candidate.bound < least.back().bound)) continue;
        least.back() = candidate;
        for (std::size_t c = kSweptBins - 1; c > 0 && least[c].bound < least[c - 1].bound; --c) std::swap(least[c], least[c - 1]);
      }
    }
    return least;
  }

  void gather(const SplitReference& reference, const Candidate& candidate, std::vector<Event>& events) const {
    const int axis = candidate.axis;
    const float low = reference.box.min[axis], high = reference.box.max[axis];
    const bool begins = bin(low, axis) == candidate.bin, ends = bin(high, axis) == candidate.bin;
    if (begins && low == high)
      events.emplace_back(low, Event::flat);
    else if (begins)
      events.emplace_back(low, Event::begin);
    if (ends && low != high) events.emplace_back(high, Event::end);
  }

  std::span<const SplitReference> references_;
  const Aabb& cell_;
  const PlaneCost& cost_;
  int bins_;
  glm::dvec3 scale_;
};

Best best_of_few(std::span<const SplitReference> references, const Aabb& cell, const PlaneCost& cost) {
  Best best;
  std::vector<Event> events;
  events.reserve(2 * references.size());
  for (int axis = 0; axis < 3; ++axis) {
    events.clear();
    for (const SplitReference& reference : references) add_events(reference, axis, events);
    sweep(events, axis, 0, references.size(), cell, cost, best);
  }
  return best;
}

}  // namespace

KdPlane cheapest_kd_plane(std::span<const SplitReference> references, const Aabb& cell, const KdTreeParams& params) {
  const PlaneCost cost(cell, params);
  if (!cost.usable() || references.empty()) return {};
  const Best best = references.size() <= kSorted ? best_of_few(references, cell, cost) : BinnedSearch(references, cell, cost).run();
  return best.cost < cost.of_leaf(references.size()) ? best.plane : KdPlane();
}

}  // namespace raymeter
