#pragma once

#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <softkin/core/error.hpp>
#include <softkin/io/picture/picture.hpp>
#include <string>
#include <vector>

namespace softkin::testing {

namespace fs = std::filesystem;
namespace fs = std::filesystem;
using Pixel = std::array<int, 3>;

inline constexpr Pixel white{255, 255, 255}, map_low{0x44, 0x01, 0x54}, map_middle{0x21, 0x91, 0x8c},
    map_high{0xfd, 0xe7, 0x25};

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;

  [[nodiscard]] Pixel at(int x, int y) const {
    const std::uint8_t* p = bytes.data() + 3 * (std::size_t(y) * width + x);
    return {p[0], p[1], p[2]};
  }
  [[nodiscard]] double covered() const {
    int count = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) count += at(x, y) != white;
    }
    return double(count) / (double(width) * height);
  }
};

inline bool near(const Pixel& a, const Pixel& b, int tolerance) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(a[k] - b[k]) > tolerance) return false;
  }
  return true;
}

inline Picture read_png(const fs::path& path) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_file(&header, path.c_str())) << header.message;
  header.format = PNG_FORMAT_RGB;
  Picture picture{int(header.width), int(header.height), std::vector<std::uint8_t>(PNG_IMAGE_SIZE(header))};
  EXPECT_TRUE(png_image_finish_read(&header, nullptr, picture.bytes.data(), 0, nullptr)) << header.message;
  return picture;
}

/// A rectangle in a plane of constant z, seen from +z it fills [x0, x1] x [y0, y1].
inline PictureLayer rectangle(double x0, double x1, double y0, double y1, double z) {
  PictureLayer layer;
  layer.points.resize(4, 3);
  layer.points << x0, y0, z, x1, y0, z, x1, y1, z, x0, y1, z;
  layer.triangles = {{0, 1, 2}, {0, 2, 3}};
  layer.edges = false;
  return layer;
}

inline PictureLayer square(double z, std::array<double, 3> color = {0, 0, 1}, double opacity = 1) {
  PictureLayer layer = rectangle(-1, 1, -1, 1, z);
  layer.color = color;
  layer.opacity = opacity;
  return layer;
}

inline PictureLayer octahedron() {
  PictureLayer layer;
  layer.points.resize(6, 3);
  layer.points << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1;
  for (const Index x : {0, 1}) {
    for (const Index y : {2, 3}) {
      for (const Index z : {4, 5}) layer.triangles.push_back({x, y, z});
    }
  }
  layer.edges = false;
  return layer;
}

inline PictureOptions from_above(int width, int height) {
  PictureOptions options;
  options.width = width;
  options.height = height;
  options.view = {0, 0, 3};
  options.up = {0, 2, 0};
  return options;
}

class PictureTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "softkin_picture_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path path() const { return folder_ / "picture.png"; }

  Picture drawn(const std::vector<PictureLayer>& layers, const PictureOptions& options) {
    write_picture(path(), layers, options);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1) << "only the picture";
    Picture picture = read_png(path());
    EXPECT_EQ(picture.width, options.width);
    EXPECT_EQ(picture.height, options.height);
    return picture;
  }

  void expect_refused(const std::vector<PictureLayer>& layers, const PictureOptions& options, const std::string& why) {
    try {
      write_picture(path(), layers, options);
      ADD_FAILURE() << "not refused: " << why;
    } catch (const InvalidInput& refusal) {
      const std::string message = refusal.what();
      EXPECT_EQ(message.rfind(path().string() + ": ", 0), 0u) << message;
      EXPECT_NE(message.find(why), std::string::npos) << message;
    }
    EXPECT_TRUE(fs::is_empty(folder_)) << why;
  }

  fs::path folder_;
};

}  // namespace softkin::testing
