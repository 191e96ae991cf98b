#include "tests/support/first_hits.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "accel/registry.h"
#include "core/ray/generators.h"
#include "core/ray/pixel_order.h"
#include "tests/support/random.h"

namespace raymeter::test {

Column<std::int32_t> pixels_of(const CameraModel& model) {
  Column<std::int32_t> pixels;
  const PixelOrder order(model.width, model.height);
  for (std::int32_t block = 0; block < order.block_count(); ++block) order.append_block(block, pixels);
  return pixels;
}

Slots::Slots(const Scene& scene, std::string_view technique, Isa isa, int packet) {
  const TechniqueSpec spec = parse_technique(technique);
  structure = spec.structure->build(scene, spec.params, 1);
  intersector = structure->intersector({isa, packet, spec.params});
  first_hit = spec.first_hit.entry->make(scene, {isa, packet, 1, spec.first_hit.params}, *intersector);
}

HitBatch Slots::find(const CameraModel& model, const Column<std::int32_t>& pixels, int threads, Counters* counters) {
  RayBatch rays;
  eye_rays(model, pixels, rays);
  HitBatch timed, counted;
  Counters sums;
  first_hit->begin(model, threads);
  first_hit->find(model, pixels, rays, timed, threads, nullptr);
  first_hit->find(model, pixels, rays, counted, threads, &sums);
  EXPECT_TRUE(bits_equal(timed, counted)) << "timed and counted kernels differ";
  if (counters != nullptr) *counters = sums;
  return timed;
}

namespace {

/// The point of the image plane at `depth` that is seen at fractional sample (x, y).
glm::dvec3 at_sample(const CameraModel& model, double x, double y, double depth) {
  const EyeRays rays(model);
  return rays.eye() + depth * (rays.center() + (2 * x - (model.width - 1)) * rays.right() + (2 * y - (model.height - 1)) * rays.down());
}

}  // namespace

Scene subsample_scene(const CameraModel& model) {
  Scene scene;
  Random random(48);
  const auto point = [&](double x, double y, double depth) { return at_sample(model, x, y, depth); };
  for (int i = 0; i < 400; ++i) {
    const double x = static_cast<double>(random.below(static_cast<std::size_t>(model.width))),
                 y = static_cast<double>(random.below(static_cast<std::size_t>(model.height)));
    const double depth = std::pow(10.0, random.uniform(-2, 4)), part = std::ldexp(1.0, -static_cast<int>(random.below(12)));
    switch (i % 8) {
      case 0: scene.add_triangle(point(x - part, y - part, depth), point(x + part, y - part, depth), point(x, y + part, depth * 1.5)); break;
      case 1: scene.add_triangle(point(x, y, depth), point(x + part, y, depth), point(x, y + part, depth)); break;
      case 2: scene.add_triangle(point(x + part, y + part, depth), point(x + 0.9, y + part, depth), point(x + 0.5, y + 0.9, depth)); break;
      case 3: scene.add_triangle(point(x - 20, y + part, depth), point(x + 20, y + part + 0x1p-8, depth), point(x + 20, y + part, 2 * depth)); break;
      case 4: scene.add_triangle(point(x - 9, y, depth), point(x + 7, y, 3 * depth), point(x + 1, y + 5, depth)); break;
      case 5: {
        const double r = 2 * glm::length(EyeRays(model).right()) * depth * part;
        scene.add_sphere(point(x + part, y, depth), r);
        scene.add_cone(point(x, y + part, depth), r, point(x + 5, y + part, 2 * depth), r / 2);
        break;
      }
      case 6:
        scene.add_polygon(std::array{point(x, y, depth), point(x + 3 * part, y, depth), point(x + part, y + part, depth), point(x, y + 3 * part, depth)});
        break;
      default:
        for (const double behind : {0.0, 1e-6, 0.0}) {
          scene.add_triangle(point(x - 3, y - 3, 1e3 + behind), point(x + 3, y - 3, 1e3 + behind), point(x, y + 3, 1e3 + behind));
        }
    }
  }
  scene.finish();
  return scene;
}

CameraModel slanted_model(CameraConvention convention) { return {{{3, 2, 5}, {-1, 0.5, -2}, {0.1, 1, 0}, 50, 0, 0, 0}, convention, 75, 53}; }

}  // namespace raymeter::test
