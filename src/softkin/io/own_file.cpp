#include <algorithm>
#include <array>
#include <softkin/io/file.hpp>
#include <softkin/io/own_file.hpp>
#include <string>

namespace softkin {

namespace {

constexpr std::size_t near_beginning = 512;  // where marks stand [bytes]

bool has_near_beginning(std::string_view text, std::string_view mark) {
  return text.substr(0, near_beginning).find(mark) != std::string_view::npos;
}

std::string_view without_blanks(std::string_view text) {
  return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

/// {"softkin": "1.0", ... of reports and their journals, {"softkin_map": ..., {"softkin_robot_fit": ... A scene has a
/// number there.
bool is_own_json(std::string_view text) {
  if (text.starts_with("{\"softkin_map\":")) return true;
  constexpr std::string_view key = "\"softkin\"";
  if (!text.starts_with('{')) return false;
  text = without_blanks(text.substr(1));
  if (text.starts_with("\"softkin_robot_fit\":") || text.starts_with("\"softkin_estimate\":")) return true;
  if (!text.starts_with(key)) return false;
  text = without_blanks(text.substr(key.size()));
  return text.starts_with(':') && without_blanks(text.substr(1)).starts_with('"');
}

/// Materials to paste into a scene; a scene that was made of them is the user's.
bool is_own_fragment(std::string_view text) {
  if (!text.starts_with("materials:   # softkin calibrate "))
    return text.starts_with("# no materials without a modulus\n");
  for (std::size_t end; (end = text.find('\n')) != std::string_view::npos;) {
    text.remove_prefix(end + 1);
    if (!text.empty() && text.front() != ' ') return false;
  }
  return true;
}

/// Text whose first line names softkin.
bool has_own_beginning(std::string_view text) {
  constexpr std::array marks{workspace_mark,
                             std::string_view("# made by softkin"),
                             std::string_view("softkin_curve: 1\n# made by softkin"),
                             gcode_mark,
                             std::string_view("softkin map journal "),
                             std::string_view("$Comments\nmade by softkin\n"),
                             std::string_view("// Types of a map exported by softkin ")};
  return std::any_of(marks.begin(), marks.end(), [text](std::string_view mark) { return text.starts_with(mark); }) ||
         ((text.starts_with("/* Where the robot ") || text.starts_with("// Where a robot goes")) &&
          has_near_beginning(text, "a map in closed form, exported by softkin "));
}

/// "2026-01-31T10:00:00.000Z      0.000 s > ...", of drive --log.
bool is_own_log(std::string_view text) {
  constexpr std::string_view form = "0000-00-00T00:00:00.000Z ";
  if (text.size() < form.size()) return false;
  for (std::size_t i = 0; i < form.size(); ++i)
    if (form[i] == '0' ? text[i] < '0' || text[i] > '9' : text[i] != form[i]) return false;
  text = without_blanks(text.substr(form.size()));
  return text.substr(std::min(text.find_first_not_of("0123456789."), text.size())).starts_with(" s ");
}

/// A table with columns that softkin alone gives together.
bool is_own_table(std::string_view text) {
  struct Header {
    std::string_view begin, end;
  };
  constexpr std::array headers{Header{"shape,along,from,to,length,predicted_mm,", ",taken,why"},  // a trace
                               Header{"waypoint,", ",error_mm,reached,inserted,equilibria"},
                               Header{"cycle,", ",sliding"},
                               Header{"direction,force_N,moved_mm,normal_N,", ",end"},
                               Header{"track,waypoint,place,reference_", ",error_mm,file"},
                               Header{"p_gauge_kpa,p_abs_kpa,ratio,unloading,", ",line"},
                               Header{"run,line,t_s,stretch,stress_mpa,", ",off"},
                               Header{"line,strain,stress_mpa,", "_mpa"},
                               Header{"pose,line,column,measured,computed,difference,kept", ""},
                               Header{"reading,line,t_s,", ",chi_square,freedoms,left_out,status"},
                               Header{"line,l1_mm,dl_mm,dl1_mm", "_off_mm"}};
  const std::string_view line = text.substr(0, text.find('\n'));
  return std::any_of(headers.begin(), headers.end(), [line](const Header& header) {
    return line.size() >= header.begin.size() + header.end.size() && line.starts_with(header.begin) &&
           line.ends_with(header.end);
  });
}

/// Pictures, shells and arrays: what is no text.
bool is_own_binary(std::string_view text) {
  constexpr std::string_view stl = "softkin", png = "\x89PNG\r\n", zip = "PK\x03\x04";
  constexpr std::size_t stl_title = 80, zip_name = 30;
  if (text.starts_with(png)) return has_near_beginning(text, std::string_view("tEXtSoftware\0softkin", 20));
  if (text.starts_with(zip)) return text.size() > zip_name && text.substr(zip_name).starts_with("softkin.npy");
  return text.size() > stl_title && text.starts_with(stl) &&
         text.substr(stl.size(), stl_title - stl.size()).find_first_not_of(' ') == std::string_view::npos;
}

}  // namespace

bool is_own_content(std::string_view content) {
  if (content.empty() || is_own_json(content) || is_own_fragment(content) || has_own_beginning(content)) return true;
  if (is_own_log(content) || is_own_table(content) || is_own_binary(content)) return true;
  if (content.starts_with("<?xml") || content.starts_with("<!--")) return has_near_beginning(content, xml_mark);
  return content.starts_with("<!") && content.find(page_mark) != std::string_view::npos;
}

bool is_own_file(const std::filesystem::path& file) {
  constexpr std::size_t piece = 1 << 16;  // holds every mark but that of a page
  const std::string begin = read_beginning(file, piece);
  return is_own_content(begin.starts_with("<!") ? read_file(file) : begin);
}

}  // namespace softkin
