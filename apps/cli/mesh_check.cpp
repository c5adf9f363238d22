#include <algorithm>
#include <optional>
#include <softkin/io/scene/scene.hpp>
#include <softkin/model/model.hpp>
#include <utility>

#include "command.hpp"
#include "mesh_command.hpp"
#include "mesh_findings.hpp"
#include "mesh_measures.hpp"
#include "mesh_text.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr std::size_t most_parts = 20, most_notes = 20;

/// What compile() says of a scene.
struct SceneVerdict {
  std::vector<std::string> notes;
  std::optional<std::string> error;
};

struct CheckReport {
  std::string file;
  int order = 1;
  std::size_t vertices = 0, tetrahedra = 0, prisms = 0;
  std::vector<Finding> findings;
  std::vector<PartMeasures> parts;
  std::optional<SceneVerdict> scene;

  [[nodiscard]] bool usable() const {
    const bool blocked = std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
      return finding.severity == Severity::error && finding.count > 0;
    });
    return !blocked && !(scene && scene->error);
  }
};

CheckReport check(const Mesh& mesh, const std::string& file) {
  const MeshCheck found = check_mesh(mesh);
  return {file,
          order_of(mesh),
          static_cast<std::size_t>(mesh.vertices.rows()),
          mesh.tetrahedra.size(),
          mesh.prisms.size(),
          findings_of(mesh, found),
          measure_parts(mesh, found),
          std::nullopt};
}

SceneVerdict try_compile(const RobotSpec& spec) {
  try {
    return {compile(spec).notes, std::nullopt};
  } catch (const InvalidInput& error) {
    return {{}, error.what()};
  }
}

CheckReport check_file(const MeshOptions& options) {
  if (!is_scene(options.input)) return check(read_mesh_in_mm(options), options.input);
  const RobotSpec spec = read_scene(options.input);
  refuse_huge(spec.mesh, options.input);
  CheckReport report = check(spec.mesh, options.input);
  report.scene = try_compile(spec);
  return report;
}

const char* text_of(Severity severity) {
  switch (severity) {
    case Severity::error:
      return "error";
    case Severity::warning:
      return "warning";
    case Severity::remark:
      return "remark";
  }
  return "";
}

std::string words(const Finding& finding) {
  std::string text = finding.kind;
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

void name(const std::vector<Index>& indices, const char* one, const char* many, std::string& text) {
  for (std::size_t i = 0; i < indices.size(); ++i) {
    text += text.empty() ? "" : i == 0 ? " and " : ", ";
    if (i == 0) text += std::string(indices.size() == 1 ? one : many) + " ";
    text += std::to_string(indices[i]);
  }
}

std::string place_text(const Place& place) {
  std::string text;
  name(place.tetrahedra, "tetrahedron", "tetrahedra", text);
  name(place.prisms, "prism", "prisms", text);
  name(place.vertices, "vertex", "vertices", text);
  return text + " at " + point_text(place.position);
}

std::string findings_text(const std::vector<Finding>& findings) {
  std::vector<std::vector<std::string>> rows;
  for (const Finding& finding : findings)
    rows.push_back({finding.count == 0 ? "ok" : text_of(finding.severity), words(finding),
                    std::to_string(finding.count), finding.count == 0 ? "" : finding.meaning});
  const std::vector<std::string> lines = aligned(rows, "llrl");
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += lines[i] + "\n";
    for (const Place& place : findings[i].first) text += "    " + place_text(place) + "\n";
    const std::size_t more = findings[i].count - findings[i].first.size();
    if (more > 0) text += "    ... and " + std::to_string(more) + " more\n";
  }
  return text;
}

std::string parts_text(const CheckReport& report) {
  std::vector<std::vector<std::string>> rows;
  for (const PartMeasures& part : report.parts)
    rows.push_back({counted(part.vertices, "vertex", "vertices"), number(part.volume) + " mm^3",
                    "centroid " + point_text(part.centroid)});
  const char* hint = report.scene               ? ""
                     : report.parts.size() == 1 ? ": a scene must hold it"
                                                : ": a scene must hold each";
  return counted(report.parts.size(), "part") + " connected through elements" + hint + "\n" +
         joined(cut(aligned(rows, "rrl"), most_parts), "    ");
}

std::string scene_text(const SceneVerdict& scene) {
  if (scene.error) return "scene refused: " + *scene.error + "\n";
  return "scene compiles" + std::string(scene.notes.empty() ? "\n" : ", and notes:\n") +
         joined(cut(scene.notes, most_notes), "    ");
}

std::string verdict_text(const CheckReport& report) {
  std::string errors = report.scene && report.scene->error ? "the scene is refused" : "", warnings;
  for (const Finding& finding : report.findings) {
    if (finding.count == 0 || finding.severity == Severity::remark) continue;
    std::string& text = finding.severity == Severity::error ? errors : warnings;
    text += (text.empty() ? "" : ", ") + words(finding) + " (" + std::to_string(finding.count) + ")";
  }
  if (!errors.empty()) return "not usable: " + errors + "\n";
  return "usable" + (warnings.empty() ? "" : ", but look at: " + warnings) + "\n";
}

std::string check_text(const CheckReport& report) {
  return report.file + ": " + counted(report.vertices, "vertex", "vertices") + ", " +
         tetrahedra_text(report.tetrahedra, report.order) + ", " + counted(report.prisms, "prism") +
         ", each numbered from 0\n" + findings_text(report.findings) + parts_text(report) +
         (report.scene ? scene_text(*report.scene) : "") + verdict_text(report);
}

Json finding_json(const Finding& finding) {
  Json first = Json::array();
  for (const Place& place : finding.first) {
    Json& json = first.emplace_back();
    if (!place.tetrahedra.empty()) json["tetrahedra"] = place.tetrahedra;
    if (!place.prisms.empty()) json["prisms"] = place.prisms;
    if (!place.vertices.empty()) json["vertices"] = place.vertices;
    json["position_mm"] = point_json(place.position);
  }
  return {{"kind", finding.kind},
          {"severity", text_of(finding.severity)},
          {"count", finding.count},
          {"meaning", finding.meaning},
          {"first", first}};
}

Json check_json(const CheckReport& report) {
  Json findings = Json::array(), parts = Json::array();
  for (const Finding& finding : report.findings) findings.push_back(finding_json(finding));
  for (const PartMeasures& part : report.parts)
    parts.push_back(
        {{"vertices", part.vertices}, {"volume_mm3", part.volume}, {"centroid_mm", point_json(part.centroid)}});
  Json json{{"file", report.file},     {"vertices", report.vertices},
            {"order", report.order},   {"tetrahedra", report.tetrahedra},
            {"prisms", report.prisms}, {"findings", findings},
            {"parts", parts}};
  if (report.scene) {
    json["scene"]["notes"] = report.scene->notes;
    json["scene"]["error"] = report.scene->error ? Json(*report.scene->error) : Json(nullptr);
  }
  json["usable"] = report.usable();
  return json;
}

}  // namespace

int mesh_check(const MeshOptions& options) {
  const CheckReport report = check_file(options);
  if (options.json)
    print(check_json(report));
  else
    print(check_text(report));
  return report.usable() ? done : not_converged;  // 1: not what was hoped for, yet the input could be read
}

}  // namespace softkin::cli
