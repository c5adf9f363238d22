#include <png.h>

#include <softkin/io/picture/png.hpp>
#include <stdexcept>

namespace softkin {

std::string encode_png(const RgbImage& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string content(size, '\0');
  if (!png_image_write_to_memory(&header, content.data(), &size, 0, image.bytes.data(), 0, nullptr)) {
    throw std::runtime_error(std::string("PNG: ") + header.message);
  }
  content.resize(size);
  return content;
}

}  // namespace softkin
