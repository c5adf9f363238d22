#include <algorithm>
#include <softkin/io/mesh/gmsh_types.hpp>

namespace softkin::gmsh {

namespace {

constexpr std::int64_t kLastType = 140;

// What a type of the format holds that softkin does not read; "": a type without a name here.
std::string_view name_of(std::int64_t type) {
  switch (type) {
    case 5:
      return "hexahedra";
    case 7:
      return "pyramids";
    case 10:
    case 16:
      return "second-order quads";
    case 12:
    case 17:
      return "second-order hexahedra";
    case 13:
    case 18:
      return "second-order prisms";
    case 14:
    case 19:
      return "second-order pyramids";
    case 21:
      return "third-order triangles";
    case 26:
      return "third-order lines";
    case 29:
      return "third-order tetrahedra";
    default:
      return "";
  }
}

bool is_read(std::int64_t type) {
  return (type >= 1 && type <= 4) || type == 6 || type == 8 || type == 9 || type == 11 || type == 15;
}

}  // namespace

CellShape shape_of(CellType type) {
  switch (type) {
    case CellType::point:
      return {0, 1};
    case CellType::line:
      return {1, 2};
    case CellType::quadratic_line:
      return {1, 3};
    case CellType::triangle:
      return {2, 3};
    case CellType::quadratic_triangle:
      return {2, 6};
    case CellType::quad:
      return {2, 4};
    case CellType::tetrahedron:
      return {3, 4};
    case CellType::quadratic_tetrahedron:
      return {3, 10};
    case CellType::prism:
      return {3, 6};
  }
  return {0, 0};
}

std::string refusal_of_type(std::int64_t type) {
  if (is_read(type)) return "";
  const std::string number = std::to_string(type);
  if (type < 1 || type > kLastType) return "unknown element type " + number;
  if (type == 5 || type == 7)
    return std::string(name_of(type)) + " (type " + number + ") are not supported: mesh with tetrahedra or prisms";
  const std::string_view name = name_of(type);
  if (name.empty()) return "elements of type " + number + " are not supported: mesh with order 1 or 2";
  return std::string(name) + " (type " + number + ") are not supported: mesh with order 1" +
         (name.starts_with("second") ? "" : " or 2");
}

bool is_unquotable(std::string_view name) {
  return std::any_of(name.begin(), name.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < ' ' || byte == 127 || c == '"';
  });
}

}  // namespace softkin::gmsh
