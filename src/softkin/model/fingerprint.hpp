#pragma once

#include <softkin/model/model.hpp>
#include <string>

namespace softkin {

/// 16 hexadecimal digits that change with anything that a compiled robot's shapes and report depend on, but not with
/// the names of its files. source: FNV-1a, 64 bit
[[nodiscard]] std::string fingerprint_of(const Model& model);

/// The same of a shape, bit by bit.
[[nodiscard]] std::string fingerprint_of(const Points& positions);

}  // namespace softkin
