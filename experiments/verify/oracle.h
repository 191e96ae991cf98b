#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/ray/ray_batch.h"
#include "core/scene/scene.h"

namespace raymeter {

/// false_hit: no surface there, or outside the ray's interval. wrong_prim: a surface, but another one is certainly nearer.
enum class Verdict { correct, false_miss, false_hit, wrong_prim };

struct Check {
  Verdict verdict = Verdict::correct;
  double t_ulp = -1;  ///< |t - exact t of that primitive| in units of the exact t's last float place; < 0: not known
};

/// |t - exact| in units of exact's last float place.
[[nodiscard]] double ulps(float t, double exact) noexcept;

/// The exact truth of a scene, by brute force over the primitives in doubles with proven error bounds, and in rationals where those cannot decide.
/// It shares no code with the tracer. A hit is correct where
///   - t is inside the ray's closed interval, and org + t dir within delta = kSurfaceError (|P - org| + size) of the named primitive's surface,
///     size being the diameter of the sphere about it (error_bounds.h),
///   - no other exact hit is nearer, except one so close in front that the primitive reaches to here within its delta.
/// An exact hit may be lost only where a ray moved by delta could lose it: at silhouettes, rims, borders of surfaces, the ends of the interval; never on an
/// edge or vertex inside a surface (covering_groups). Invalid rays miss. Ties may go to any of the tied ones: that they go to the smallest id is the tests'
/// affair. Thread-safe. The scene must outlive it.
class Oracle {
public:
  explicit Oracle(const Scene& scene);
  /// Checks a nearest hit: t and prim as in HitView.
  [[nodiscard]] Check closest(const Ray& ray, float t, std::int32_t prim) const;
  /// Checks a blocker, -1 for none: it must be a primitive that the ray hits in its interval.
  [[nodiscard]] Check any(const Ray& ray, std::int32_t blocker) const;
  /// The exact nearest hit, whatever kernels may err; of hits that are equally near to 2^-36 that of the smallest id.
  struct Exact {
    std::int32_t prim;
    double t;
  };
  [[nodiscard]] std::optional<Exact> nearest(const Ray& ray) const;
  [[nodiscard]] std::size_t prim_count() const noexcept { return bounds_.size(); }

private:
  /// A sphere about a primitive.
  struct Bounds {
    double center[3];
    double radius;
    std::int32_t prim;
  };
  struct Near;

  /// What a ray has to do with the primitives that it may meet before t_end.
  [[nodiscard]] Near near(const Ray& ray, double t_end) const;
  /// Whether an exact hit before t_end would certainly be found.
  [[nodiscard]] bool hit_is_due(const Ray& ray, const Near& near, double t_end) const;
  /// Whether org + t dir lies on the primitive's surface within delta.
  [[nodiscard]] bool on_surface(const Ray& ray, std::int32_t prim, double t) const;
  /// Whether the surface follows the ray from t to `end` within delta.
  [[nodiscard]] bool reaches(const Ray& ray, std::int32_t prim, double t, double end) const;

  const Scene& scene_;
  std::vector<Bounds> bounds_;
  std::vector<std::int32_t> bounds_of_;  ///< index into bounds_ by primitive id, -1 for dropped ones
};

}  // namespace raymeter
