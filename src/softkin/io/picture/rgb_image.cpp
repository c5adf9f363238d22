#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <softkin/io/picture/rgb_image.hpp>
#include <stdexcept>

namespace softkin {

namespace {

constexpr int intervals = 8;
constexpr std::uint8_t knots[intervals + 1][3] = {{0x44, 0x01, 0x54}, {0x47, 0x2d, 0x7b}, {0x3b, 0x52, 0x8b},
                                                  {0x2c, 0x72, 0x8e}, {0x21, 0x91, 0x8c}, {0x28, 0xae, 0x80},
                                                  {0x5e, 0xc9, 0x62}, {0xad, 0xdc, 0x30}, {0xfd, 0xe7, 0x25}};

Rgb knot(int i) {
  return {knots[i][0] / 255.0, knots[i][1] / 255.0, knots[i][2] / 255.0};
}

}  // namespace

Rgb mapped_color(double fraction) {
  const double place = std::clamp(fraction, 0.0, 1.0) * intervals;
  const int left = std::min(static_cast<int>(place), intervals - 1);
  return mixed(knot(left), knot(left + 1), place - left);
}

namespace {

void append_big_endian(std::string& bytes, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift & 255);
}

/// Says which program made the picture.
std::string software_chunk() {
  const std::string content("tEXtSoftware\0softkin", 20);
  std::string chunk;
  append_big_endian(chunk, static_cast<std::uint32_t>(content.size() - 4));
  chunk += content;
  append_big_endian(chunk, static_cast<std::uint32_t>(::crc32(0, reinterpret_cast<const Bytef*>(content.data()),
                                                              static_cast<uInt>(content.size()))));
  return chunk;
}

}  // namespace

std::string encode_png(const RgbImage& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string content(size, '\0');
  if (!png_image_write_to_memory(&header, content.data(), &size, 0, image.bytes.data(), 0, nullptr))
    throw std::runtime_error(std::string("PNG: ") + header.message);
  content.resize(size);
  constexpr std::size_t after_header = 33;  // signature and IHDR
  return content.insert(after_header, software_chunk());
}

}  // namespace softkin
