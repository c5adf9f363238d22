#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/model/model.hpp>
#include <softkin/runs/records.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace softkin::runs {

/// What a run writes.
struct RunFiles {
  std::filesystem::path report{};  // JSON; empty: none
  std::filesystem::path shapes{};  // .pvd of a series, its shapes next to it; empty: none
};

/// A record that names other actuators than the model has.
struct OtherActuators : InvalidInput {
  OtherActuators() : InvalidInput("the record has other actuators") {}  // with this message
};

/// How a record is written and read: a line of JSON.
template <class Record>
struct Codec {
  std::function<std::string(const Record&)> write;    // one line, without its end
  std::function<Record(std::string_view line)> read;  // throws  InvalidInput where the line is none of write
};

/// The records of a run on disk. During the run they are in a journal next to the report, REPORT.run; at its end they
/// become the report and the series. A killed run leaves its journal and the shapes, and no half-written file.
class RecordLog {
 public:
  /// head  the report's entries before its steps: a JSON object on one line
  /// same  keys of the head that a run to be resumed must have had alike, beside version, robot, solver and start
  RecordLog(const Model& model, RunFiles files, const std::string& head, std::vector<std::string> same);
  ~RecordLog();
  RecordLog(RecordLog&&) noexcept;

  /// Continues the journal or, where there is none, the report; else begins.
  ///
  /// take     called with every line; throws where it is not the requested record (refuse)
  /// remark   for the user, of missing or damaged records; empty: there are none
  /// throws   InvalidInput where it is no report, or one of another robot, solver, start or `same`
  void resume(const std::function<const StepRecord&(std::size_t number, std::string_view line)>& take,
              std::string& remark);
  [[noreturn]] void refuse(const std::string& why) const;

  /// How many records there are.
  [[nodiscard]] std::size_t size() const;

  /// Takes the journal before the first record is made, so that no second softkin writes beside this one; nothing where
  /// that is done. Throws as Store
  void begin();

  /// Writes the shape into the series and the record, with its shape, behind the others.
  void add_shape(StepRecord& record, const State& state, const ElementDeformation& deformation) const;
  /// The same of a record that was stopped on its path, which is none of the others: the shape next to the series, and,
  /// by note_stopped(), the record in the report.
  void add_stopped_shape(StepRecord& record, const State& state, const ElementDeformation& deformation) const;
  void note_stopped(std::string_view line);
  void add(std::string_view line, double seconds);
  /// The shape of a record as it was written; none where it is not there.
  [[nodiscard]] std::optional<Points> shape_of(std::size_t number, const StepRecord& record) const;
  void each(const std::function<bool(std::size_t number, std::string_view line)>& visit) const;

  /// One more entry of the report's head.
  void note(const std::string& key, const std::vector<double>& values);
  /// The report, piece by piece.
  void report(const std::function<void(std::string_view piece)>& write) const;
  /// Writes the report of what there is, and removes the journal.
  void finish();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// A RecordLog of one kind of records.
template <class Record>
class TypedLog : public RecordLog {
 public:
  /// As RecordLog; codec: how its records are written.
  TypedLog(const Model& model, RunFiles files, const std::string& head, std::vector<std::string> same,
           Codec<Record> codec)
      : RecordLog(model, std::move(files), head, std::move(same)), codec_(std::move(codec)) {}

  /// check: returns why a record is not the requested one; empty: it is
  void resume(const std::function<std::string(std::size_t number, const Record&)>& check, std::string& remark) {
    Record record;
    RecordLog::resume(
        [&](std::size_t number, std::string_view line) -> const StepRecord& {
          try {
            record = codec_.read(line);
          } catch (const OtherActuators&) {
            refuse("step " + std::to_string(number) + " has other actuators");
          } catch (const InvalidInput& error) {
            refuse(error.what());
          }
          if (const std::string why = check(number, record); !why.empty()) refuse(why);
          return record;
        },
        remark);
  }
  void add(Record& record, const State& state, const ElementDeformation& deformation) {
    add_shape(record, state, deformation);
    RecordLog::add(codec_.write(record), record.seconds);
  }
  void add_stopped(Record& record, const State& state, const ElementDeformation& deformation) {
    add_stopped_shape(record, state, deformation);
    note_stopped(codec_.write(record));
  }
  void each(const std::function<void(std::size_t number, const Record&)>& visit) const {
    RecordLog::each([&](std::size_t number, std::string_view line) {
      visit(number, codec_.read(line));
      return true;
    });
  }
  [[nodiscard]] std::vector<Record> all() const {
    std::vector<Record> records;
    each([&](std::size_t, const Record& record) { records.push_back(record); });
    return records;
  }
  [[nodiscard]] Record at(std::size_t number) const {
    Record record;
    RecordLog::each([&](std::size_t each, std::string_view line) {
      if (each == number) record = codec_.read(line);
      return each < number;
    });
    return record;
  }

 private:
  Codec<Record> codec_;
};

}  // namespace softkin::runs
