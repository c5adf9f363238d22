#include "measure.hpp"

int main(int argc, char** argv) {
  return softkin::cli::measure_program(argc, argv);
}
