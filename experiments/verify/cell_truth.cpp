#include "experiments/verify/cell_truth.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/base/threads.h"
#include "experiments/verify/number.h"
#include "experiments/verify/sample.h"

namespace raymeter {

namespace {

using verify::Arithmetic;

/// When a ray reaches a coordinate: way / speed, exactly; speed > 0. `approximate` is good to 2^-51: a difference and a quotient of floats.
struct Time {
  float to, from;
  float speed;
  double approximate;
};

Time time_of(const Ray& ray, std::size_t a, float plane) {
  const bool backwards = ray.dir[a] < 0;
  const float to = backwards ? -plane : plane, from = backwards ? -ray.org[a] : ray.org[a];
  const float speed = std::abs(ray.dir[a]);
  return {to, from, speed, (double{to} - double{from}) / double{speed}};
}

Time time_of(float t) { return {t, 0, 1, t}; }

/// -1, 0, 1: whether a is before b, exactly.
int order(const Time& a, const Time& b) {
  const double difference = a.approximate - b.approximate;
  if (std::abs(difference) > (std::abs(a.approximate) + std::abs(b.approximate)) * 0x1p-50) return difference < 0 ? -1 : 1;
  if (std::isinf(a.to) || std::isinf(b.to)) return a.to == b.to ? 0 : a.approximate < b.approximate ? -1 : 1;
  return verify::decide(Arithmetic::filtered, [&]<class N>() {
    const N way_a = N(double{a.to}) - N(double{a.from}), way_b = N(double{b.to}) - N(double{b.from});
    return verify::sign(N(way_a * N(double{b.speed}) - way_b * N(double{a.speed})));
  });
}

/// The planes that a ray still has before it on one axis.
class AxisPlanes {
public:
  AxisPlanes(const CellWalk::Cells& cells, const Ray& ray, std::size_t a) : planes_(cells.planes[a]), ray_(ray), a_(a), up_(ray.dir[a] > 0) {}

  [[nodiscard]] bool moves() const noexcept { return ray_.dir[a_] != 0; }
  /// Goes to the cell in which the ray stands from `begin` on; false where it lies in a plane between cells.
  bool start(const Time& begin) {
    if (!moves()) {
      cell_ = static_cast<std::size_t>(std::ranges::lower_bound(planes_, ray_.org[a_]) - planes_.begin());
      return cell_ == planes_.size() || planes_[cell_] != ray_.org[a_];
    }
    // Of the planes in the ray's order those that it has crossed by then.
    std::size_t crossed = 0;
    for (std::size_t beyond = planes_.size(); crossed < beyond;) {
      const std::size_t middle = (crossed + beyond) / 2;
      if (order(time_of(ray_, a_, plane(middle)), begin) <= 0)
        crossed = middle + 1;
      else
        beyond = middle;
    }
    cell_ = up_ ? crossed : planes_.size() - crossed;
    return true;
  }
  [[nodiscard]] bool ends() const noexcept { return !moves() || cell_ == (up_ ? planes_.size() : 0); }
  [[nodiscard]] Time next() const { return time_of(ray_, a_, planes_[up_ ? cell_ : cell_ - 1]); }
  void step() noexcept { up_ ? ++cell_ : --cell_; }
  [[nodiscard]] std::size_t cell() const noexcept { return cell_; }

private:
  [[nodiscard]] float plane(std::size_t k) const noexcept { return planes_[up_ ? k : planes_.size() - 1 - k]; }

  const std::vector<float>& planes_;
  const Ray& ray_;
  std::size_t a_;
  bool up_;
  std::size_t cell_ = 0;
};

bool valid(const Ray& ray) noexcept {
  bool moves = false;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!std::isfinite(ray.org[a]) || !std::isfinite(ray.dir[a])) return false;
    moves = moves || ray.dir[a] != 0;
  }
  return moves && ray.t_min <= ray.t_max;
}

/// How many steps along its direction a ray is in a cell.
class Progress {
public:
  Progress(const CellWalk::Cells& cells, const Ray& ray) {
    for (std::size_t a = 0; a < 3; ++a) {
      size_[a] = static_cast<std::int32_t>(cells.resolution(a));
      down_[a] = ray.dir[a] < 0;
    }
  }
  [[nodiscard]] std::int32_t operator()(std::int32_t cell) const noexcept {
    const std::array<std::int32_t, 3> at{cell % size_[0], cell / size_[0] % size_[1], cell / size_[0] / size_[1]};
    std::int32_t sum = 0;
    for (std::size_t a = 0; a < 3; ++a) sum += down_[a] ? -at[a] : at[a];
    return sum;
  }

private:
  std::array<std::int32_t, 3> size_{};
  std::array<bool, 3> down_{};
};

/// Both in the ray's order, in which progress rises.
void compare(const CellWalk::Cells& cells, const Ray& ray, const std::vector<PassedCell>& passed, const std::int32_t* visited, std::int32_t count,
             CellAccuracy& accuracy) {
  const Progress progress(cells, ray);
  std::int32_t k = 0;
  std::int64_t missed = 0;
  bool at_risk = false;
  for (const PassedCell& one : passed) {
    const std::int32_t wanted = progress(one.cell);
    while (k < count && progress(visited[k]) < wanted) ++k;
    if (k < count && visited[k] == one.cell) continue;
    ++missed;
    for (std::size_t a = 0; a < 3; ++a) {
      if (cells.planes[a].empty()) continue;  // nothing to measure by
      accuracy.longest = std::max(accuracy.longest, one.way[a] / cells.cell_size[a]);
      at_risk = at_risk || one.way[a] > cells.margin[a];
    }
  }
  accuracy.cells_missed += missed;
  accuracy.rays_missing += missed > 0 ? 1 : 0;
  accuracy.rays_at_risk += at_risk ? 1 : 0;
  ++accuracy.rays_checked;
}

}  // namespace

std::vector<PassedCell> cells_passed(const CellWalk::Cells& cells, const Ray& ray) {
  std::vector<PassedCell> passed;
  if (!valid(ray)) return passed;
  Time begin = time_of(ray.t_min), end = time_of(ray.t_max);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<glm::length_t>(a);
    const float low = cells.box.min[axis], high = cells.box.max[axis];
    if (ray.dir[a] == 0) {
      if (ray.org[a] < low || ray.org[a] > high) return passed;
      continue;
    }
    const Time in = time_of(ray, a, ray.dir[a] > 0 ? low : high), out = time_of(ray, a, ray.dir[a] > 0 ? high : low);
    if (order(in, begin) > 0) begin = in;
    if (order(out, end) < 0) end = out;
  }
  if (order(begin, end) >= 0) return passed;
  std::array<AxisPlanes, 3> axes{AxisPlanes(cells, ray, 0), AxisPlanes(cells, ray, 1), AxisPlanes(cells, ray, 2)};
  for (AxisPlanes& axis : axes) {
    if (!axis.start(begin)) return passed;
  }
  for (Time now = begin;;) {
    AxisPlanes* first = nullptr;
    Time next = end;
    for (AxisPlanes& axis : axes) {
      if (axis.ends()) continue;
      const Time time = axis.next();
      if (order(time, next) < 0) {
        next = time;
        first = &axis;
      }
    }
    if (order(now, next) < 0) {
      const std::size_t cell = axes[0].cell() + cells.resolution(0) * (axes[1].cell() + cells.resolution(1) * axes[2].cell());
      const double time = next.approximate - now.approximate;
      passed.push_back({static_cast<std::int32_t>(cell), {time * std::abs(ray.dir[0]), time * std::abs(ray.dir[1]), time * std::abs(ray.dir[2])}});
    }
    if (first == nullptr) return passed;
    now = next;
    first->step();
  }
}

CellAccuracy verify_cells(const CellWalk& walk, const RayBatch& rays, const OracleBudget& budget) {
  constexpr std::size_t kBlock = 256;
  const CellWalk::Cells cells = walk.cells();
  RayBatch chosen;
  for (const std::size_t i : sampled(rays.size(), cells.most(), budget.max_tests, budget.seed)) chosen.push_back(rays[i]);
  CellAccuracy sum;
  std::mutex lock;
  on_threads(budget.threads, [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chosen.size(), kBlock), [&](const tbb::blocked_range<std::size_t>& range) {
      const std::size_t size = range.size();
      std::vector<std::int32_t> visited(size * cells.most()), count(size);
      walk.walk(chosen.view(range.begin(), size), visited.data(), count.data());
      CellAccuracy part;
      for (std::size_t i = 0; i < size; ++i) {
        if (count[i] == CellWalk::kEverywhere) continue;
        const Ray ray = chosen[range.begin() + i];
        compare(cells, ray, cells_passed(cells, ray), visited.data() + i * cells.most(), count[i], part);
      }
      const std::lock_guard guard(lock);
      sum.rays_checked += part.rays_checked;
      sum.rays_missing += part.rays_missing;
      sum.rays_at_risk += part.rays_at_risk;
      sum.cells_missed += part.cells_missed;
      sum.longest = std::max(sum.longest, part.longest);
    });
  });
  return sum;
}

}  // namespace raymeter
