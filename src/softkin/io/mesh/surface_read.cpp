#include <softkin/io/file.hpp>
#include <softkin/io/mesh/file_form.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/surface_files.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>

namespace softkin {

TriangleSurface read_surface(const std::filesystem::path& path) {
  std::string content = read_file(path);
  const std::string file = path.string();
  if (trimmed(content).empty()) throw InvalidInput({file}, "the file is empty");
  const FileForm form = form_of_content(content);
  if (form != FileForm::stl && content.starts_with("\xef\xbb\xbf")) content.replace(0, 3, "   ");
  switch (form) {
    case FileForm::stl:
      return read_stl(file, content);
    case FileForm::obj:
      return read_obj(file, std::move(content));
    case FileForm::ply:
      return read_ply(file, content);
    case FileForm::off:
      return read_off(file, std::move(content));
    case FileForm::unknown:
      break;
    default:
      throw InvalidInput({file}, "the file is " + std::string(words_of(form)) +
                                     ", and a surface is read from STL, OBJ, PLY or OFF: export it as one of these");
  }
  const std::string extension = lower_extension(path);
  if (extension == ".stl") return read_stl(file, content);
  if (extension == ".obj") return read_obj(file, std::move(content));
  if (extension == ".ply") return read_ply(file, content);
  if (extension == ".off") return read_off(file, std::move(content));
  throw InvalidInput({file},
                     "the file is of no form that softkin recognises, and a surface is read from STL, OBJ, PLY "
                     "or OFF: export it as one of these");
}

}  // namespace softkin
