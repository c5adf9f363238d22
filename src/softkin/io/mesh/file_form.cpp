#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <softkin/io/mesh/file_form.hpp>
#include <softkin/io/mesh/surface_files.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>

namespace softkin {

namespace {

struct Mark {
  std::string_view begin;
  FileForm form;
};

/// What files begin with, behind blanks and a byte order mark.
constexpr Mark beginnings[] = {{"$MeshFormat", FileForm::gmsh},
                               {"$NOD", FileForm::gmsh},
                               {"$Comments", FileForm::gmsh},
                               {"# vtk DataFile", FileForm::vtk_legacy},
                               {"MeshVersionFormatted", FileForm::medit},
                               {"ISO-10303-21", FileForm::step},
                               {"DBRep_DrawableShape", FileForm::brep},
                               {"CASCADE Topology", FileForm::brep},
                               {"glTF", FileForm::gltf},
                               {"#VRML", FileForm::vrml},
                               {"#X3D", FileForm::vrml},
                               {"\x89HDF\r\n\x1a\n", FileForm::hdf5},
                               {"Kaydara FBX Binary", FileForm::fbx},
                               {"PK\x03\x04", FileForm::zip},
                               {"\x89PNG", FileForm::picture},
                               {"\xff\xd8\xff", FileForm::picture}};

/// Elements by which files of XML, and the word "asset" by which glTF as text, are known.
constexpr Mark elements[] = {{"<VTKFile", FileForm::vtk_xml}, {"<COLLADA", FileForm::collada},
                             {"<amf", FileForm::amf},         {"<febio_spec", FileForm::febio},
                             {"<X3D", FileForm::vrml},        {"<model", FileForm::threemf}};

constexpr std::size_t looked_at = 4096;  // bytes

/// Does a binary STL of so many facets have this size?
bool has_size_of_stl(std::string_view content) {
  constexpr std::size_t header = 84, facet = 50;
  if (content.size() < header + facet) return false;
  std::uint32_t facets = 0;
  std::memcpy(&facets, content.data() + 80, sizeof facets);
  if constexpr (std::endian::native == std::endian::big) facets = __builtin_bswap32(facets);
  return content.size() == header + facet * std::size_t{facets};
}

std::string_view first_word(std::string_view text) {
  const std::size_t end = text.find_first_of(" \t\r\n\v\f");
  return text.substr(0, end);
}

bool equals_lower(std::string_view text, std::string_view word) {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

/// Behind lines that are blank or a comment.
std::string_view after_comments(std::string_view text) {
  while (true) {
    text = text.substr(std::min(text.find_first_not_of(" \t\r\n\v\f"), text.size()));
    if (!text.starts_with("#")) return text;
    text = text.substr(std::min(text.find('\n'), text.size()));
  }
}

bool is_obj_word(std::string_view word) {
  static constexpr std::string_view words[] = {"v",  "vn", "vt", "vp",     "f",      "o",      "g",  "s",
                                               "mg", "l",  "p",  "mtllib", "usemtl", "cstype", "lod"};
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

bool is_abaqus(std::string_view text) {
  return text.starts_with("**") ||
         (text.starts_with("*") && text.size() > 1 && std::isalpha(static_cast<unsigned char>(text[1])) != 0);
}

/// The first line of IGES has 'S' and its number in columns 73 to 80.
bool is_iges(std::string_view text) {
  return text.size() >= 80 && text[72] == 'S' && text.substr(73, 7).find_first_not_of(" 0123456789") == text.npos &&
         text[79] == '1';
}

}  // namespace

FileForm form_of_content(std::string_view content) {
  if (has_size_of_stl(content)) return FileForm::stl;
  if (is_iges(content)) return FileForm::iges;
  if (content.starts_with("\xef\xbb\xbf")) content.remove_prefix(3);
  const std::string_view text = trimmed(content.substr(0, looked_at));
  for (const auto& [begin, form] : beginnings)
    if (text.starts_with(begin)) return form;
  if (first_word(text) == "ply") return FileForm::ply;
  if (equals_lower(first_word(text), "solid")) return FileForm::stl;
  if (text.starts_with("<"))
    for (const auto& [element, form] : elements)
      if (text.find(element) != text.npos) return form;
  if (text.starts_with("{") && text.find("\"asset\"") != text.npos) return FileForm::gltf;
  if (is_abaqus(text)) return FileForm::abaqus;
  const std::string_view word = first_word(after_comments(content));
  if (is_off_keyword(word)) return FileForm::off;
  if (is_obj_word(word)) return FileForm::obj;
  return FileForm::unknown;
}

const char* words_of(FileForm form) {
  switch (form) {
    case FileForm::unknown:
      return "of no known form";
    case FileForm::stl:
      return "an STL surface";
    case FileForm::obj:
      return "an OBJ surface";
    case FileForm::ply:
      return "a PLY surface";
    case FileForm::off:
      return "an OFF surface";
    case FileForm::gmsh:
      return "a Gmsh mesh";
    case FileForm::vtk_legacy:
      return "a legacy VTK file";
    case FileForm::vtk_xml:
      return "a VTK XML file";
    case FileForm::medit:
      return "a Medit mesh";
    case FileForm::abaqus:
      return "an Abaqus input file";
    case FileForm::step:
      return "a STEP model";
    case FileForm::iges:
      return "an IGES model";
    case FileForm::brep:
      return "a BREP model of Open CASCADE";
    case FileForm::gltf:
      return "a glTF scene";
    case FileForm::collada:
      return "a COLLADA scene";
    case FileForm::threemf:
      return "a 3MF model";
    case FileForm::vrml:
      return "a VRML or X3D scene";
    case FileForm::amf:
      return "an AMF model";
    case FileForm::febio:
      return "a FEBio model";
    case FileForm::hdf5:
      return "an HDF5 file";
    case FileForm::fbx:
      return "an FBX scene";
    case FileForm::zip:
      return "a zip archive, as 3MF models are";
    case FileForm::picture:
      break;
  }
  return "a picture";
}

}  // namespace softkin
