#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <glm/vec3.hpp>

namespace raymeter {

/// A pinhole camera in NFF's terms. Vectors need not be normalised, `up` need not be orthogonal. The field of view is the full angle of both axes, in degrees.
struct Camera {
  glm::dvec3 eye{0.0, 0.0, 1.0};
  glm::dvec3 look_at{0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  double fov_degrees = 45;
  double hither = 0;
  int width = 512;
  int height = 512;
  friend bool operator==(const Camera&, const Camera&) = default;
};

/// Where the samples of an image lie, and with it the rules of the comparison that the image belongs to (render/whitted.h has the rest of them).
/// Sample i of N lies, in units of tan(fov / 2), at
enum class CameraConvention : std::uint8_t {
  spd,     ///< (2i - (N-1)) / (N-2): with N = 513 the pixel corners of NFF's 512 pixels, whose outermost centres span the field of view
  havran,  ///< 2i / (N-1) - 1: the outermost samples span the field of view
  pixel,   ///< (2i + 1) / N - 1: pixel centres; the outermost pixel borders span the field of view
};

inline constexpr std::array kCameraConventions{CameraConvention::spd, CameraConvention::havran, CameraConvention::pixel};
[[nodiscard]] constexpr std::string_view name(CameraConvention convention) noexcept {
  constexpr std::array<std::string_view, kCameraConventions.size()> names{"spd", "havran", "pixel"};
  return names[static_cast<std::size_t>(convention)];
}

[[nodiscard]] constexpr std::optional<CameraConvention> camera_convention_from_name(std::string_view text) noexcept {
  for (const CameraConvention convention : kCameraConventions) {
    if (name(convention) == text) return convention;
  }
  return std::nullopt;
}

/// Which eye rays an image has. Pixels are square: where width and height differ, the field of view is that of the vertical axis.
struct CameraModel {
  Camera camera;
  CameraConvention convention = CameraConvention::pixel;
  int width = 512;
  int height = 512;
  [[nodiscard]] std::int32_t pixel_count() const noexcept { return width * height; }
};

/// The eye rays of a camera model. A view direction or `up` that gives no frame (zero, parallel) is replaced by an axis.
class EyeRays {
public:
  explicit EyeRays(const CameraModel& model) noexcept;
  [[nodiscard]] const glm::dvec3& eye() const noexcept { return eye_; }
  /// Unit direction through sample (x, y), x to the right from 0, y downwards from 0.
  [[nodiscard]] glm::dvec3 direction(int x, int y) const noexcept;
  /// Unit, towards what is looked at; the two below are perpendicular to it.
  [[nodiscard]] const glm::dvec3& center() const noexcept { return center_; }
  /// Half a sample distance to the right, and downwards, on the image plane at distance 1.
  [[nodiscard]] const glm::dvec3& right() const noexcept { return right_; }
  [[nodiscard]] const glm::dvec3& down() const noexcept { return down_; }

private:
  glm::dvec3 eye_;
  glm::dvec3 center_;
  glm::dvec3 right_;
  glm::dvec3 down_;
  int width_;
  int height_;
};

}  // namespace raymeter
