#include "experiments/run/pass.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>

#include "core/trace/trace.h"

namespace raymeter {

namespace {

double cpu_ms() noexcept {
  std::timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void mix(std::uint64_t& hash, std::uint32_t word) noexcept { hash = (hash ^ word) * 0x100000001b3u; }

}  // namespace

std::uint64_t Answers::hash() const noexcept {
  std::uint64_t hash = 0xcbf29ce484222325u;
  if (kind == Kind::any) {
    for (const std::int32_t prim : blocker) mix(hash, prim >= 0 ? 1 : 0);
    return hash;
  }
  if (kind == Kind::image) {
    for (const glm::vec3& pixel : image.pixel) {
      for (const float value : {pixel.x, pixel.y, pixel.z}) mix(hash, std::bit_cast<std::uint32_t>(value));
    }
    return hash;
  }
  for (std::size_t i = 0; i < hits.size(); ++i) {
    mix(hash, static_cast<std::uint32_t>(hits.prim[i]));
    for (const float value : {hits.t[i], hits.u[i], hits.v[i]}) mix(hash, std::bit_cast<std::uint32_t>(value));
  }
  return hash;
}

std::int64_t Answers::hit_count() const noexcept {
  const Column<std::int32_t>& prims = kind == Kind::any ? blocker : hits.prim;
  return std::count_if(prims.begin(), prims.end(), [](std::int32_t prim) { return prim >= 0; });
}

std::int64_t count_differences(const Answers& a, const Answers& b) noexcept {
  std::int64_t count = 0;
  if (a.kind == Answers::Kind::any) {
    for (std::size_t i = 0; i < a.blocker.size(); ++i) count += (a.blocker[i] >= 0) != (b.blocker[i] >= 0) ? 1 : 0;
    return count;
  }
  if (a.kind == Answers::Kind::image) {
    for (std::size_t i = 0; i < a.image.pixel.size(); ++i) count += std::memcmp(&a.image.pixel[i], &b.image.pixel[i], sizeof(glm::vec3)) != 0 ? 1 : 0;
    return count;
  }
  const auto differ = [](float x, float y) noexcept { return std::bit_cast<std::uint32_t>(x) != std::bit_cast<std::uint32_t>(y); };
  for (std::size_t i = 0; i < a.hits.size(); ++i) {
    const bool same =
        a.hits.prim[i] == b.hits.prim[i] && !differ(a.hits.t[i], b.hits.t[i]) && !differ(a.hits.u[i], b.hits.u[i]) && !differ(a.hits.v[i], b.hits.v[i]);
    count += same ? 0 : 1;
  }
  return count;
}

PassTime run_pass(const Tracers& tracers, const RaySet& set, int threads, Answers& answers, Counters* counters) {
  answers.kind = set.query == Query::any ? Answers::Kind::any : Answers::Kind::closest;
  PassTime time;
  const double cpu_before = cpu_ms();
  const auto start = std::chrono::steady_clock::now();
  if (tracers.first_hit != nullptr) {
    tracers.first_hit->begin(set.model, threads);
    time.prepare_ms = ms_since(start);
    tracers.first_hit->find(set.model, set.pixel, set.rays, answers.hits, threads, counters);
  } else if (tracers.occlusion != nullptr) {
    tracers.occlusion->begin();
    tracers.occlusion->find(set.rays, set.origins, answers.blocker, threads, counters);
  } else {
    tracers.intersector.prepare(set.rays.view(), set.query, threads);
    time.prepare_ms = ms_since(start);
    if (set.query == Query::closest)
      trace_closest(tracers.intersector, set.rays, answers.hits, threads, counters);
    else
      trace_any(tracers.intersector, set.rays, answers.blocker, threads, counters);
  }
  time.trace_ms = ms_since(start);
  time.cpu_ms = cpu_ms() - cpu_before;
  return time;
}

FramePass run_frame(const Tracers& tracers, const Frame& frame, int threads, Answers& answers, bool count) {
  answers.kind = Answers::Kind::image;
  CastFirstHit cast(tracers.intersector);
  FirstHit& first_hit = tracers.first_hit != nullptr ? *tracers.first_hit : cast;
  const double cpu_before = cpu_ms();
  const auto start = std::chrono::steady_clock::now();
  Rendering rendering = render(*frame.scene, first_hit, tracers.intersector,
                               {frame.model, frame.termination, threads, count, tracers.occlusion, count, frame.general, frame.lights});
  const PassTime time{0, ms_since(start), cpu_ms() - cpu_before};
  answers.image = std::move(rendering.image);
  return {time, rendering.rays, std::move(rendering.depth), rendering.totals, std::move(rendering.bound)};
}

RaySet sample_of(const RaySet& set, std::size_t blocks) {
  constexpr std::size_t kBlock = kMaxPacket;
  RaySet few;
  few.query = set.query;
  const std::size_t all = (set.rays.size() + kBlock - 1) / kBlock;
  const std::size_t taken = std::min(blocks, all);
  for (std::size_t block = 0; block < taken; ++block) {
    const std::size_t first = block * all / taken * kBlock;
    for (std::size_t i = first; i < std::min(first + kBlock, set.rays.size()); ++i) few.rays.push_back(set.rays[i]);
  }
  return few;
}

double estimate_pass_s(Intersector& intersector, const RaySet& set) {
  constexpr std::size_t kBlocks = 8;
  const RaySet few = sample_of(set, kBlocks);
  if (few.rays.size() == 0) return 0;
  Answers answers;
  const PassTime time = run_pass({intersector}, few, 1, answers);
  return time.trace_ms * 1e-3 * static_cast<double>(set.rays.size()) / static_cast<double>(few.rays.size());
}

double estimate_frame_s(const Tracers& tracers, const Frame& frame) {
  constexpr double kPixels = 1024;
  const double pixels = frame.model.pixel_count();
  const double shrink = std::sqrt(std::min(1.0, kPixels / pixels));
  Frame small = frame;
  small.model.width = std::max(1, static_cast<int>(frame.model.width * shrink));
  small.model.height = std::max(1, static_cast<int>(frame.model.height * shrink));
  Answers answers;
  const FramePass pass = run_frame(tracers, small, 1, answers);
  return pass.time.trace_ms * 1e-3 * pixels / small.model.pixel_count();
}

}  // namespace raymeter
