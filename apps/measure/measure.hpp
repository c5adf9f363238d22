#pragma once

#include <softkin/vision/measure_request.hpp>
#include <string>
#include <vector>

namespace softkin::cli {

/// The options of `softkin measure PICTURES`.
struct PicturesOptions : vision::MeasureOptions {
  std::vector<std::string> pictures;
  std::string output;
  double fps = 0;  // 0: not given
  int threads = 0;
  bool json = false, may_replace = false;
};

/// The whole program `softkin measure`; returns its exit code.
[[nodiscard]] int measure_program(int argc, const char* const* argv);

// The commands; return the exit code, throw InvalidInput.
[[nodiscard]] int measure_photos(const PicturesOptions& options);
[[nodiscard]] int measure_film(const PicturesOptions& options);

}  // namespace softkin::cli
