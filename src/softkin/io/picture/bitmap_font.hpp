#pragma once

namespace softkin {

constexpr int glyph_columns = 5, glyph_rows = 9;  // capitals take the upper 7 rows, two are for descenders
constexpr int glyph_advance = 6;                  // columns from one character to the next

/// Whether a cell of the character is inked; a character outside ASCII 32..126 is an empty box.
[[nodiscard]] bool glyph_cell(char character, int column, int row);

}  // namespace softkin
