#include "core/ray/ray_batch.h"

#include <cstring>

namespace raymeter {

void RayBatch::resize(std::size_t size) {
  for (int a = 0; a < 3; ++a) {
    org[a].resize(size);
    dir[a].resize(size);
  }
  t_min.resize(size);
  t_max.resize(size);
}

void RayBatch::reserve(std::size_t size) {
  for (int a = 0; a < 3; ++a) {
    org[a].reserve(size);
    dir[a].reserve(size);
  }
  t_min.reserve(size);
  t_max.reserve(size);
}

void RayBatch::clear() noexcept {
  for (int a = 0; a < 3; ++a) {
    org[a].clear();
    dir[a].clear();
  }
  t_min.clear();
  t_max.clear();
}

void RayBatch::push_back(const Ray& ray) {
  for (int a = 0; a < 3; ++a) {
    org[a].push_back(ray.org[a]);
    dir[a].push_back(ray.dir[a]);
  }
  t_min.push_back(ray.t_min);
  t_max.push_back(ray.t_max);
}

void RayBatch::append(const RayBatch& other) {
  for (std::size_t a = 0; a < 3; ++a) {
    org[a].append(other.org[a]);
    dir[a].append(other.dir[a]);
  }
  t_min.append(other.t_min);
  t_max.append(other.t_max);
}

void RayBatch::set(std::size_t i, const Ray& ray) noexcept {
  for (int a = 0; a < 3; ++a) {
    org[a][i] = ray.org[a];
    dir[a][i] = ray.dir[a];
  }
  t_min[i] = ray.t_min;
  t_max[i] = ray.t_max;
}

Ray RayBatch::operator[](std::size_t i) const noexcept { return {{org[0][i], org[1][i], org[2][i]}, t_min[i], {dir[0][i], dir[1][i], dir[2][i]}, t_max[i]}; }

RayView RayBatch::view(std::size_t first, std::size_t count) const noexcept {
  return {{org[0].data() + first, org[1].data() + first, org[2].data() + first},
          {dir[0].data() + first, dir[1].data() + first, dir[2].data() + first},
          t_min.data() + first,
          t_max.data() + first,
          static_cast<std::int32_t>(count)};
}

void HitBatch::resize(std::size_t size) {
  t.resize(size);
  prim.resize(size, -1);
  u.resize(size);
  v.resize(size);
}

HitView HitBatch::view(std::size_t first, std::size_t count) noexcept {
  return {t.data() + first, prim.data() + first, u.data() + first, v.data() + first, static_cast<std::int32_t>(count)};
}

bool bits_equal(const HitBatch& a, const HitBatch& b) noexcept {
  const auto same = [](const auto& p, const auto& q) noexcept {
    return p.size() == q.size() && (p.empty() || std::memcmp(p.data(), q.data(), p.size() * sizeof(p[0])) == 0);
  };
  return same(a.t, b.t) && same(a.prim, b.prim) && same(a.u, b.u) && same(a.v, b.v);
}

}  // namespace raymeter
