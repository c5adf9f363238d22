#include <nlohmann/json.hpp>
#include <ostream>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/model/model.hpp>
#include <softkin/runs/record_log.hpp>
#include <softkin/runs/records_json.hpp>
#include <softkin/runs/shape_files.hpp>
#include <softkin/runs/store.hpp>
#include <utility>

namespace softkin::runs {

namespace fs = std::filesystem;

struct RecordLog::Parts {
  const Model& model;
  RunFiles files;
  Json head;
  std::vector<std::string> same;
  std::optional<Store> store;
  double seconds = 0;

  void write(const fs::path& file, StepRecord& record, const State& state,
             const ElementDeformation& deformation) const {
    write_shape(file, model, state, deformation, record.status == Status::converged);
    record.shape = file.filename().string();
    record.shape_fingerprint = fingerprint_of(state.positions);
  }
  [[nodiscard]] fs::path journal() const { return files.report.empty() ? fs::path() : journal_of(files.report); }
};

RecordLog::RecordLog(const Model& model, RunFiles files, const std::string& head, std::vector<std::string> same)
    : parts_(new Parts{model, std::move(files), Json::parse(head), std::move(same), {}, 0}) {}

RecordLog::~RecordLog() {
  if (parts_ && parts_->store && size() == 0) parts_->store->remove();
}

RecordLog::RecordLog(RecordLog&&) noexcept = default;

void RecordLog::refuse(const std::string& why) const {
  throw InvalidInput({parts_->files.report.string()}, "cannot go on from this report: " + why);
}

namespace {

/// Why a run with the head `before` cannot be gone on with; empty: it can.
std::string difference(const Json& before, const Json& head, const std::vector<std::string>& same) {
  const auto differs = [&](const std::string& key) {  // whatever the order of keys
    return nlohmann::json(before.at(key)) != nlohmann::json(head.at(key));
  };
  if (differs("softkin")) return "softkin " + before.at("softkin").get<std::string>() + " wrote it";
  if (differs("robot_fingerprint")) return "it is of another robot, or the scene or its mesh has changed";
  const auto other = [&](const std::string& key, const std::string& what) {
    return "it was made with other " + what + ": " + before.at(key).dump() + " instead of " + head.at(key).dump();
  };
  if (differs("solver")) return other("solver", "solver options");
  const auto start = [](const Json& of) { return of.contains("start") ? of["start"].at("shape_fingerprint") : Json(); };
  if (start(before) != start(head)) return "it began at another shape";
  for (const std::string& key : same)
    if (differs(key)) return other(key, "options");
  return "";
}

}  // namespace

void RecordLog::resume(const std::function<const StepRecord&(std::size_t, std::string_view)>& take,
                       std::string& remark) {
  Parts& log = *parts_;
  const bool journal = fs::exists(log.journal());
  if (!journal && !fs::exists(log.files.report)) {
    remark = "there is no " + log.files.report.string() + " yet";
    return;
  }
  try {
    Json before;
    if (journal) {
      log.store.emplace(log.journal(), line_of(log.head) + "\n", true);
      before = parse_json(log.store->head());
    } else {
      before = parse_json(read_file(log.files.report));
    }
    if (const std::string why = difference(before, log.head, log.same); !why.empty()) refuse(why);
    if (!journal) {
      // nothing is written before all of it is found good
      std::string text = line_of(log.head) + "\n";
      for (std::size_t i = 0; i < before.at("steps").size(); ++i) {
        const std::string line = line_of(before.at("steps").at(i));
        (void)take(i, line);
        text += line + "\n";
      }
      write_file(log.journal(), text);  // all of it at once: a kill leaves the report or the journal
      log.store.emplace(log.journal(), line_of(log.head) + "\n", true);
    }
    std::size_t good = 0;
    log.store->each([&](std::size_t i, std::string_view line) {
      const StepRecord& record = take(i, line);
      if (!shape_of(i, record)) {
        remark = series_file(log.files.shapes, i).string() + " is missing or not the shape of the report";
        return false;
      }
      log.seconds += record.seconds;
      ++good;
      return true;
    });
    log.store->cut(good);
  } catch (const Json::exception&) {
    refuse("it is not a report that this command wrote");
  }
}

std::size_t RecordLog::size() const {
  return parts_->store ? parts_->store->size() : 0;
}

void RecordLog::add_shape(StepRecord& record, const State& state, const ElementDeformation& deformation) const {
  if (!parts_->files.shapes.empty())
    parts_->write(series_file(parts_->files.shapes, size()), record, state, deformation);
}

void RecordLog::add_stopped_shape(StepRecord& record, const State& state, const ElementDeformation& deformation) const {
  if (!parts_->files.shapes.empty()) parts_->write(stopped_file(parts_->files.shapes), record, state, deformation);
}

void RecordLog::note_stopped(std::string_view line) {
  parts_->head["stopped"] = parse_json(line);
}

void RecordLog::begin() {
  if (!parts_->store) parts_->store.emplace(parts_->journal(), line_of(parts_->head) + "\n", false);
}

void RecordLog::add(std::string_view line, double seconds) {
  begin();
  parts_->store->append(line);
  parts_->seconds += seconds;
}

std::optional<Points> RecordLog::shape_of(std::size_t number, const StepRecord& record) const {
  try {
    Points positions = read_vtu_points(series_file(parts_->files.shapes, number));
    if (fingerprint_of(positions) == record.shape_fingerprint) return positions;
  } catch (const InvalidInput&) {  // not there or damaged: the step is solved again
  }
  return std::nullopt;
}

void RecordLog::each(const std::function<bool(std::size_t, std::string_view)>& visit) const {
  if (parts_->store) parts_->store->each(visit);
}

void RecordLog::note(const std::string& key, const std::vector<double>& values) {
  parts_->head[key] = values;
}

void RecordLog::report(const std::function<void(std::string_view)>& write) const {
  std::string piece = "{\n";
  for (const auto& [key, value] : parts_->head.items()) piece += " " + line_of(key) + ": " + line_of(value) + ",\n";
  write(piece + " \"steps\": [");
  each([&](std::size_t i, std::string_view line) {
    write(i > 0 ? ",\n  " : "\n  ");
    write(line);
    return true;
  });
  write((size() == 0 ? "" : "\n ") + std::string("],\n \"seconds\": ") + line_of(parts_->seconds) + "\n}\n");
}

void RecordLog::finish() {
  const bool stopped = parts_->head.contains("stopped");
  if (!stopped && !parts_->files.shapes.empty()) fs::remove(stopped_file(parts_->files.shapes));
  if (!parts_->store) return;
  if (!parts_->files.report.empty() && (size() > 0 || stopped))
    write_file(parts_->files.report, [this](std::ostream& stream) {
      report([&](std::string_view piece) { stream.write(piece.data(), static_cast<std::streamsize>(piece.size())); });
    });
  parts_->store->remove();
}

}  // namespace softkin::runs
