#include <gtest/gtest.h>

#include "core/base/error.h"
#include "experiments/npy.h"

namespace raymeter {
namespace {

std::string npy(const std::string& dictionary, std::size_t data_bytes, char version = '\1') {
  std::string bytes("\x93NUMPY", 6);
  bytes += version;
  bytes += '\0';
  bytes += static_cast<char>(dictionary.size() & 0xff);
  bytes += static_cast<char>(dictionary.size() >> 8);
  if (version > 1) bytes.append(2, '\0');
  return bytes + dictionary + std::string(data_bytes, '\0');
}

std::string message(const std::string& bytes) {
  try {
    (void)parse_rays_npy(bytes, "r.npy");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Npy, ReadsVersionsOneToThree) {
  for (const char version : {'\1', '\2', '\3'}) {
    const RayBatch rays = parse_rays_npy(npy("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 8), }\n", 96, version), "r.npy");
    EXPECT_EQ(rays.size(), 3u) << int{version};
  }
}

TEST(Npy, PutsTheColumnsWhereTheyBelong) {
  std::string bytes = npy("{\"shape\":(1,8),\"fortran_order\":False,\"descr\":\"<f4\"}", 0);
  for (const float value : {1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f, 8.0f}) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  const Ray ray = parse_rays_npy(bytes, "r.npy")[0];
  EXPECT_EQ(ray.org[0], 1.0f);
  EXPECT_EQ(ray.org[2], 3.0f);
  EXPECT_EQ(ray.t_min, 4.0f);
  EXPECT_EQ(ray.dir[0], 5.0f);
  EXPECT_EQ(ray.dir[2], 7.0f);
  EXPECT_EQ(ray.t_max, 8.0f);
}

TEST(Npy, ReadsNoRays) { EXPECT_EQ(parse_rays_npy(npy("{'descr': '<f4', 'fortran_order': False, 'shape': (0, 8)}", 0), "r.npy").size(), 0u); }

TEST(Npy, SaysWhatIsWrong) {
  const std::string good = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 8)}";
  EXPECT_EQ(message(""), "r.npy: not a .npy file: expected it to begin with \\x93NUMPY");
  EXPECT_EQ(message("\x93NUMPY\x01"), "r.npy: truncated in its .npy header");
  EXPECT_EQ(message(npy(good, 64).substr(0, 40)), "r.npy: truncated in its .npy header");
  EXPECT_EQ(message(npy(good, 64, '\4')), "r.npy: .npy version 4, expected 1, 2 or 3");
  EXPECT_EQ(message(npy(good, 63)), "r.npy: truncated: 63 bytes of data, expected 2 rays of 32 bytes");
  EXPECT_EQ(message(npy(good, 65)), "r.npy: 1 bytes after the last ray, expected none");
  EXPECT_EQ(message(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 8)}", 128)), "r.npy: dtype '<f8', expected float32 ('<f4')");
  EXPECT_EQ(message(npy("{'descr': [('t', '<f4')], 'fortran_order': False, 'shape': (2,)}", 8)), "r.npy: dtype '[('t', '<f4')]', expected float32 ('<f4')");
  EXPECT_EQ(message(npy("{'descr': '<f4', 'fortran_order': False, 'shape': (16,)}", 64)), "r.npy: shape '(16,)', expected (N, 8): ox oy oz tmin dx dy dz tmax");
  EXPECT_EQ(message(npy("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 8)}", 64)), "r.npy: Fortran order, expected C order");
  EXPECT_EQ(message(npy("{'descr': '<f4', 'shape': (2, 8)}", 64)), "r.npy: broken .npy header: expected the keys descr, fortran_order and shape at byte 33");
  EXPECT_EQ(message(npy("{'descr': '<f4', 'fortran_order': Maybe, 'shape': (2, 8)}", 64)), "r.npy: broken .npy header: expected True or False at byte 34");
  EXPECT_EQ(message(npy("{'size': 3}", 0)), "r.npy: broken .npy header: expected a known key at byte 7");
  EXPECT_EQ(message(npy("{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999, 8)}", 64)),
            "r.npy: truncated: 64 bytes of data, expected 99999999999999 rays of 32 bytes");
}

}  // namespace
}  // namespace raymeter
