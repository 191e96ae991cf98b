// Rays that run in the planes of volumes, exactly: slabs off the axes, oriented boxes turned by 45 degrees, volumes of points, lines and planes. Volumes and
// rays are made of whole numbers of 1/64, so that no plane is met, or missed, by rounding; what a ray meets is decided in rationals all the same.

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "core/bounds/kdop_volume.h"
#include "core/bounds/obb_volume.h"
#include "core/bounds/sphere_volume.h"
#include "tests/support/random.h"
#include "tests/support/test_rays.h"
#include "tests/support/volume_targets.h"

namespace raymeter {
namespace {

using glm::dvec3;
using test::Count;
using test::Kernels;
using test::Random;
using test::Slab;
using test::Target;
using test::VolumeKernel;

constexpr double kStep = 1.0 / 64;  // a float's at the far place
constexpr int kVolumes = 1000;      // of each kind in each place
constexpr int kRays = 60;           // a volume
const std::array kPlaces{dvec3(0.0), dvec3(100000, 130000, 160000)};

int whole(Random& random, int least, int most) { return least + static_cast<int>(random.below(static_cast<std::size_t>(most - least + 1))); }

dvec3 whole_vector(Random& random, int most) {
  const int x = whole(random, -most, most), y = whole(random, -most, most);
  return {x, y, whole(random, -most, most)};
}

/// Not 0, of small whole numbers and exactly perpendicular to a vector of such.
dvec3 across(const dvec3& normal, Random& random) {
  for (;;) {
    const dvec3 v = glm::cross(normal, whole_vector(random, 3));
    if (v != dvec3(0)) return v;
  }
}

/// From a point, some way back along a direction of whole numbers, which it takes with any exact factor and zeros of either sign.
Ray through(const dvec3& at, const dvec3& dir, Random& random) {
  const dvec3 org = at - static_cast<double>(whole(random, 0, 6)) * dir;
  dvec3 scaled = std::exp2(whole(random, -40, 40)) * dir;
  for (glm::length_t a = 0; a < 3; ++a) {
    if (scaled[a] == 0 && random.below(2) == 0) scaled[a] = -0.0;
  }
  const Ray ray = test::make_ray(org, scaled);
  for (glm::length_t a = 0; a < 3; ++a) EXPECT_EQ(double{ray.org[a]}, org[a]);
  return ray;
}

/// Rays that truly meet their volumes, and those that pass them at a distance that no rounding explains.
struct Counts {
  Count meeting, passing;

  void add(const Target& target, const RayBatch& near, const RayBatch& far, VolumeKernel Kernels::*kernel) {
    RayBatch met, passed;
    for (std::size_t i = 0; i < near.size(); ++i) {
      if (test::truly_meets(near[i], target.slabs)) met.push_back(near[i]);
    }
    for (std::size_t i = 0; i < far.size(); ++i) {
      if (!test::truly_meets(far[i], target.slabs)) passed.push_back(far[i]);
    }
    trace(target, met, kernel, meeting);
    trace(target, passed, kernel, passing);
  }
  void expect(std::int64_t at_least) const {
    test::expect_all_met(meeting, at_least);
    EXPECT_GE(passing.rays, at_least / 10);
    for (const double met : passing.met) EXPECT_EQ(met, 0) << "the volume does not cull";
  }
};

Slab slab_of(const dvec3& normal, const dvec3& origin, float low, float high) {
  Slab slab{{}, {}, low, high};
  test::set(slab.normal, normal);
  test::set(slab.origin, origin);
  return slab;
}

/// Slabs about a point whose planes lie up to `most` of it, some with both planes in one place.
Target slabs_about(const KdopVolume& volume, const dvec3& at, int most, Random& random) {
  Kdop kdop;
  Target target{std::vector<float>(static_cast<std::size_t>(volume.floats())), {}, volume.shared({}), 1, at};
  for (std::size_t i = 0; i < volume.directions().size(); ++i) {
    const dvec3 normal(volume.directions()[i]);
    const double height = glm::dot(normal, at - dvec3(volume.origin()));
    kdop.min[i] = static_cast<float>(height - kStep * (random.below(4) == 0 ? 0 : whole(random, 0, most)));
    kdop.max[i] = static_cast<float>(height + kStep * (random.below(4) == 0 ? 0 : whole(random, 0, most)));
    target.slabs.push_back(slab_of(normal, dvec3(volume.origin()), kdop.min[i], kdop.max[i]));
  }
  volume.write(kdop, target.data.data());
  return target;
}

TEST(FlatVolumes, SlabsHoldRaysInTheirPlanes) {
  constexpr std::array kSizes{6, 8, 12, 14, 18, 20, 26};
  Random random(21);
  for (const dvec3& place : kPlaces) {
    SCOPED_TRACE(place.x);
    Scene scene;
    scene.add_sphere(place, 16);
    scene.finish();
    std::vector<KdopVolume> volumes;
    for (const int k : kSizes) volumes.emplace_back(scene, k);
    Counts counts;
    for (int v = 0; v < kVolumes; ++v) {
      const KdopVolume& volume = volumes[random.below(volumes.size())];
      const dvec3 at = place + kStep * whole_vector(random, 640);
      const Target target = slabs_about(volume, at, 256, random);
      RayBatch near, far;
      for (int k = 0; k < kRays; ++k) {
        const std::size_t i = random.below(target.slabs.size());
        const dvec3 normal(volume.directions()[i]);
        glm::length_t axis = 0;  // along which the direction is 1 or -1
        while (normal[axis] == 0) ++axis;
        const double height = glm::dot(normal, at - dvec3(volume.origin()));
        const bool high = random.below(2) == 0;
        const double plane = high ? double{target.slabs[i].high} : double{target.slabs[i].low}, out = high ? 1 : -1;
        const auto at_height = [&](double h) {
          dvec3 p = at;
          p[axis] += (h - height) / normal[axis];
          return p;
        };
        const dvec3 dir = across(normal, random);
        near.push_back(through(at_height(plane), dir, random));                // in the plane
        near.push_back(through(at_height(plane - out * kStep), dir, random));  // just inside, if the slab is not flat
        far.push_back(through(at_height(plane + out), dir, random));
      }
      counts.add(target, near, far, &Kernels::slabs);
    }
    counts.expect(kVolumes * kRays / 2);
  }
}

/// An oriented box with two of its axes in a plane of the world's, turned by 45 degrees, and the whole numbers that are parallel to its axes.
struct TurnedBox {
  Target target;
  std::array<dvec3, 3> along;
  std::array<double, 3> reach;  ///< in units of `along`: half widths
};

/// `reach_of` gives the half widths, which are exact for powers of two and 0.
template <class ReachOf>
TurnedBox turned_box(const dvec3& center, ReachOf reach_of, Random& random) {
  const auto upright = static_cast<glm::length_t>(random.below(3));
  std::array<dvec3, 3> along{dvec3(0.0), dvec3(0.0), dvec3(0.0)};
  along[0][(upright + 1) % 3] = along[0][(upright + 2) % 3] = along[1][(upright + 2) % 3] = along[2][upright] = 1;
  along[1][(upright + 1) % 3] = -1;
  std::rotate(along.begin(), along.begin() + whole(random, 0, 2), along.end());
  const float half_root = std::sqrt(0.5f);
  Obb box;
  box.center = glm::vec3(center);
  TurnedBox turned{{std::vector<float>(16), {}, {}, 1, center}, along, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    const bool is_turned = glm::dot(along[i], along[i]) == 2;
    turned.reach[i] = reach_of(i);
    box.axis[i] = glm::vec3(along[i]) * (is_turned ? half_root : 1.0f);
    // Of `reach` times (1, 1, 0), the product with (s, s, 0).
    box.half[static_cast<glm::length_t>(i)] = static_cast<float>(turned.reach[i] * (is_turned ? 2.0 * double{half_root} : 1.0));
    turned.target.slabs.push_back(slab_of(dvec3(box.axis[i]), center, -box.half[static_cast<glm::length_t>(i)], box.half[static_cast<glm::length_t>(i)]));
  }
  ObbVolume{}.write(box, turned.target.data.data());
  return turned;
}

/// A ray in the plane at the share of the half width along axis i.
Ray in_plane(const TurnedBox& box, std::size_t i, double share, Random& random) {
  dvec3 dir(0.0);
  while (dir == dvec3(0)) dir = double(whole(random, -3, 3)) * box.along[(i + 1) % 3] + double(whole(random, -3, 3)) * box.along[(i + 2) % 3];
  return through(box.target.middle + share * box.reach[i] * box.along[i], dir, random);
}

TEST(FlatVolumes, BoxesTurnedBy45DegreesHoldRaysInTheirFaces) {
  Random random(22);
  for (const dvec3& place : kPlaces) {
    SCOPED_TRACE(place.x);
    Counts counts;
    for (int v = 0; v < kVolumes; ++v) {
      const TurnedBox box = turned_box(
          place + kStep * whole_vector(random, 640), [&](std::size_t) { return std::exp2(whole(random, -4, 3)); }, random);
      RayBatch near, far;
      for (int k = 0; k < kRays; ++k) {
        const std::size_t i = random.below(3);
        const double side = random.below(2) == 0 ? 1 : -1;
        near.push_back(in_plane(box, i, side, random));
        near.push_back(in_plane(box, i, 0.75 * side, random));
        far.push_back(in_plane(box, i, 6 * side, random));
      }
      counts.add(box.target, near, far, &Kernels::oriented);
    }
    counts.expect(kVolumes * kRays);
  }
}

/// One, two or three half widths are 0: a rectangle, a line, a point. Rays at them from anywhere, and in their planes.
TEST(FlatVolumes, BoxesOfPointsLinesAndPlanesAreMet) {
  Random random(23);
  for (const dvec3& place : kPlaces) {
    SCOPED_TRACE(place.x);
    Counts counts;
    for (int v = 0; v < kVolumes; ++v) {
      const std::size_t extended = random.below(3);  // axes along which it is
      const auto reach_of = [&](std::size_t i) { return i < extended ? std::exp2(whole(random, -2, 3)) : 0; };
      const TurnedBox box = turned_box(place + kStep * whole_vector(random, 640), reach_of, random);
      RayBatch near;
      for (int k = 0; k < kRays; ++k) {
        dvec3 at = box.target.middle, dir(0.0);
        for (std::size_t i = 0; i < extended; ++i) at += box.reach[i] * whole(random, -4, 4) / 4.0 * box.along[i];
        while (dir == dvec3(0)) dir = whole_vector(random, 3);
        near.push_back(through(at, dir, random));
        near.push_back(in_plane(box, random.below(3), 1, random));
      }
      counts.add(box.target, near, {}, &Kernels::oriented);
    }
    test::expect_all_met(counts.meeting, kVolumes * kRays);
  }
}

/// The same for boxes along the axes, which a ray in their plane meets with 0 * infinity.
TEST(FlatVolumes, FlatBoxesAlongTheAxesAreMet) {
  Random random(24);
  for (const dvec3& place : kPlaces) {
    SCOPED_TRACE(place.x);
    Counts counts;
    for (int v = 0; v < kVolumes; ++v) {
      const dvec3 low = place + kStep * whole_vector(random, 640);
      dvec3 high = low;
      const auto flat = static_cast<glm::length_t>(random.below(3));
      for (glm::length_t a = 0; a < 3; ++a) high[a] += a == flat || random.below(4) == 0 ? 0 : whole(random, 1, 8);
      Target target{std::vector<float>(6), {}, {}, 1, low};
      for (glm::length_t a = 0; a < 3; ++a) {
        target.data[static_cast<std::size_t>(a)] = static_cast<float>(low[a]);
        target.data[static_cast<std::size_t>(a + 3)] = static_cast<float>(high[a]);
        dvec3 normal(0.0);
        normal[a] = 1;
        target.slabs.push_back(slab_of(normal, dvec3(0), static_cast<float>(low[a]), static_cast<float>(high[a])));
      }
      RayBatch near, far;
      for (int k = 0; k < kRays; ++k) {
        dvec3 at = low, normal(0.0);
        for (glm::length_t a = 0; a < 3; ++a) at[a] += (high[a] - low[a]) * whole(random, 0, 4) / 4.0;
        normal[flat] = 1;
        const dvec3 dir = across(normal, random);
        near.push_back(through(at, dir, random));
        at[flat] += random.below(2) == 0 ? 1 : -1;
        far.push_back(through(at, dir, random));
      }
      counts.add(target, near, far, &Kernels::boxes);
    }
    counts.expect(kVolumes * kRays);
  }
}

/// What volumes of degenerate primitives store: rays at their vertices and at points between, which have no area to hit, but may not pass the volume.
TEST(FlatVolumes, OrientedBoxesOfDegeneratePrimitivesHoldThem) {
  Random random(25);
  for (const dvec3& place : kPlaces) {
    SCOPED_TRACE(place.x);
    Count count;
    for (int v = 0; v < kVolumes; ++v) {
      std::array<dvec3, 3> vertex;
      vertex.fill(place + kStep * whole_vector(random, 640));
      const dvec3 along = kStep * whole_vector(random, 256);
      const std::size_t kind = random.below(3);  // a point, a line, a plane
      if (kind >= 1) vertex[1] += along, vertex[2] += random.below(2) == 0 ? 2.0 * along : along;
      if (kind == 2) vertex[2] += kStep * whole_vector(random, 256);
      Scene scene;
      scene.add_triangle(vertex[0], vertex[1], vertex[2]);
      scene.finish();
      constexpr std::array kAxes{ObbAxes::object, ObbAxes::pca, ObbAxes::best};
      const ObbVolume volume{kAxes[random.below(kAxes.size())]};
      const Obb box = volume.fit(scene, scene.prim(0));
      Target target{std::vector<float>(16), {}, {}, 1, vertex[0]};
      volume.write(box, target.data.data());
      RayBatch rays;
      for (int k = 0; k < kRays; ++k) {
        dvec3 dir(0.0);
        while (dir == dvec3(0)) dir = whole_vector(random, 3);
        rays.push_back(through(vertex[random.below(3)], dir, random));
      }
      trace(target, rays, &Kernels::oriented, count);
    }
    test::expect_all_met(count, kVolumes * kRays);
  }
}

TEST(FlatVolumes, SpheresOfPointsAreMet) {
  Random random(26);
  for (const dvec3& place : kPlaces) {
    SCOPED_TRACE(place.x);
    Count count;
    for (int v = 0; v < kVolumes; ++v) {
      const dvec3 center = place + kStep * whole_vector(random, 640);
      Target target{std::vector<float>(4), {}, {}, 1, center};
      SphereVolume{}.write({glm::vec3(center), 0}, target.data.data());
      RayBatch rays;
      for (int k = 0; k < kRays; ++k) {
        dvec3 dir(0.0);
        while (dir == dvec3(0)) dir = whole_vector(random, 3);
        rays.push_back(through(center, dir, random));
      }
      trace(target, rays, &Kernels::spheres, count);
    }
    test::expect_all_met(count, kVolumes * kRays);
  }
}

}  // namespace
}  // namespace raymeter
