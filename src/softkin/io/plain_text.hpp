#pragma once

#include <string>
#include <string_view>

namespace softkin {

/// First byte that text meant for people does not have: a control character (tab, CR and LF aside) or malformed UTF-8;
/// npos where there is none.
[[nodiscard]] std::size_t find_unprintable(std::string_view text);

/// The beginning of text in single quotes, safe to print whatever text holds; for messages.
[[nodiscard]] std::string excerpt(std::string_view text);

/// A name out of a file as it is, where that is safe to print on one line; else its excerpt.
[[nodiscard]] std::string printable(const std::string& name);

/// For XML: the characters & < > " as entities.
[[nodiscard]] std::string xml_escaped(std::string_view text);

}  // namespace softkin
