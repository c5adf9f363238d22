#pragma once

#include "requests.hpp"

namespace softkin::cli {

struct CameraOptions {
  std::vector<std::string> pictures;
  std::string board, output;
  int threads = 0;
  bool json = false;
};

struct BoardOptions {
  std::string board, output;
  double dpi = 300;
};

// The commands; return the exit code, throw InvalidInput.
[[nodiscard]] int measure_photos(const MeasureOptions& options);
[[nodiscard]] int measure_film(const MeasureOptions& options);
[[nodiscard]] int measure_camera(const CameraOptions& options);
[[nodiscard]] int measure_board(const BoardOptions& options);

}  // namespace softkin::cli
