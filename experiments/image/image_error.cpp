#include "experiments/image/image_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace raymeter {

namespace {

// Wang, Bovik, Sheikh, Simoncelli 2004 (IEEE TIP 13(4)), as scikit-image's structural_similarity with gaussian_weights=True, sigma=1.5,
// use_sample_covariance=False, data_range=1 and channel_axis=2 computes it: mean over the pixels whose window is whole and over the channels.
constexpr int kRadius = 5;
constexpr int kWindow = 2 * kRadius + 1;

std::array<double, kWindow> window_weights() {
  constexpr double kSigma = 1.5;
  std::array<double, kWindow> weight{};
  double sum = 0;
  for (int i = 0; i < kWindow; ++i) sum += weight[static_cast<std::size_t>(i)] = std::exp(-0.5 * (i - kRadius) * (i - kRadius) / (kSigma * kSigma));
  for (double& one : weight) one /= sum;
  return weight;
}

/// Weighted means over a window, of one channel of two images: values, squares and products.
struct Moments {
  glm::dvec2 mean{0};
  glm::dvec2 square{0};
  double product = 0;

  void add(double weight, const Moments& other) {
    mean += weight * other.mean;
    square += weight * other.square;
    product += weight * other.product;
  }
  [[nodiscard]] double similarity() const {
    constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;
    const double means = mean.x * mean.y, squares = glm::dot(mean, mean);
    const double variances = square.x + square.y - squares, covariance = product - means;
    return (2 * means + kC1) * (2 * covariance + kC2) / ((squares + kC1) * (variances + kC2));
  }
};

Moments moments(float a, float b) {
  const glm::dvec2 value = glm::clamp(glm::dvec2(a, b), 0.0, 1.0);
  return {value, value * value, value.x * value.y};
}

/// Of one channel; the window is separable: columns of each row of windows first.
double structural_similarity(const Image& a, const Image& b, glm::length_t channel) {
  static const std::array<double, kWindow> weight = window_weights();
  const int across = a.width - 2 * kRadius, down = a.height - 2 * kRadius;
  std::vector<Moments> column(static_cast<std::size_t>(a.width));
  double sum = 0;
  for (int top = 0; top < down; ++top) {
    for (int x = 0; x < a.width; ++x) {
      Moments& moment = column[static_cast<std::size_t>(x)] = {};
      for (int i = 0; i < kWindow; ++i) {
        const auto pixel = static_cast<std::size_t>(top + i) * static_cast<std::size_t>(a.width) + static_cast<std::size_t>(x);
        moment.add(weight[static_cast<std::size_t>(i)], moments(a.pixel[pixel][channel], b.pixel[pixel][channel]));
      }
    }
    for (int left = 0; left < across; ++left) {
      Moments window;
      for (int i = 0; i < kWindow; ++i) window.add(weight[static_cast<std::size_t>(i)], column[static_cast<std::size_t>(left + i)]);
      sum += window.similarity();
    }
  }
  return sum / (static_cast<double>(across) * down);
}

}  // namespace

double ImageError::psnr() const noexcept { return rmse > 0 ? -20 * std::log10(rmse) : std::numeric_limits<double>::infinity(); }

ImageError image_error(const Image& image, const Image& reference) {
  ImageError error;
  double sum = 0;
  for (std::size_t i = 0; i < image.pixel.size(); ++i) {
    const glm::dvec3 difference = glm::dvec3(image.pixel[i]) - glm::dvec3(reference.pixel[i]);
    sum += glm::dot(difference, difference);
  }
  if (!image.pixel.empty()) error.rmse = std::sqrt(sum / (3 * static_cast<double>(image.pixel.size())));
  if (std::min(image.width, image.height) >= kWindow) {
    double similarity = 0;
    for (glm::length_t channel = 0; channel < 3; ++channel) similarity += structural_similarity(image, reference, channel);
    error.ssim = similarity / 3;
  }
  return error;
}

BoundCheck check_bound(const Image& image, const Image& reference, const Column<glm::vec3>& bound) {
  BoundCheck check;
  for (std::size_t i = 0; i < image.pixel.size(); ++i) {
    bool exceeded = false;
    for (glm::length_t channel = 0; channel < 3; ++channel) {
      const double error = std::abs(double{image.pixel[i][channel]} - double{reference.pixel[i][channel]});
      const double most = bound[i][channel];
      check.error_mean += error;
      check.bound_mean += most;
      check.error_max = std::max(check.error_max, error);
      check.bound_max = std::max(check.bound_max, most);
      exceeded = exceeded || !(error <= most);
    }
    check.exceeded += exceeded ? 1 : 0;
  }
  if (!image.pixel.empty()) {
    const double values = 3 * static_cast<double>(image.pixel.size());
    check.error_mean /= values;
    check.bound_mean /= values;
  }
  return check;
}

}  // namespace raymeter
