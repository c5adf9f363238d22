#include <cstring>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/core/version.hpp>
#include <softkin/io/base64.hpp>
#include <softkin/io/file.hpp>
#include <softkin/model/model.hpp>
#include <softkin/runs/map_journal.hpp>
#include <sstream>

namespace softkin::runs {

namespace {

/// Bytes of numbers and arrays with their sizes, bit by bit.
class Packer {
 public:
  template <class Matrix>
  void add(const Matrix& matrix) {
    add_number(matrix.rows());
    add_number(matrix.cols());
    bytes_.append(reinterpret_cast<const char*>(matrix.data()),
                  static_cast<std::size_t>(matrix.size()) * sizeof(typename Matrix::Scalar));
  }
  void add_number(std::int64_t number) { bytes_.append(reinterpret_cast<const char*>(&number), sizeof number); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::string bytes) : bytes_(std::move(bytes)) {}

  template <class Matrix>
  void take(Matrix& matrix) {
    const std::int64_t rows = take_number(), columns = take_number();
    const std::size_t scalar = sizeof(typename Matrix::Scalar);
    if (rows < 0 || columns < 0 ||
        (columns > 0 &&
         static_cast<std::size_t>(rows) > (bytes_.size() - at_) / scalar / static_cast<std::size_t>(columns)))
      throw InvalidInput("a record is broken");
    matrix.resize(rows, columns);
    const std::size_t size = static_cast<std::size_t>(matrix.size()) * scalar;
    std::memcpy(matrix.data(), bytes_.data() + at_, size);
    at_ += size;
  }
  std::int64_t take_number() {
    std::int64_t number = 0;
    if (bytes_.size() - at_ < sizeof number) throw InvalidInput("a record is broken");
    std::memcpy(&number, bytes_.data() + at_, sizeof number);
    at_ += sizeof number;
    return number;
  }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

/// What a record holds, in its order.
template <class Sample, class Visit>
void visit_arrays(Sample& sample, const Visit& visit) {
  visit(sample.commands);
  visit(sample.values);
  visit(sample.slopes);
  visit(sample.moves);
  visit(sample.state.positions);
  visit(sample.state.actuation);
  visit(sample.state.multipliers);
}

std::string packed_sample(const maps::Sample& sample) {
  Packer packer;
  visit_arrays(sample, [&](const auto& array) { packer.add(array); });
  return packer.bytes();
}

maps::Sample unpacked_sample(std::string bytes) {
  Unpacker unpacker(std::move(bytes));
  maps::Sample sample;
  visit_arrays(sample, [&](auto& array) { unpacker.take(array); });
  return sample;
}

/// Lines that identify all inputs of the records.
std::string journal_head(const Model& model, const MapOptions& options) {
  std::string ranges;
  for (const Actuator& actuator : model.actuators)
    ranges += " " + actuator.name + " " + exact(actuator.low) + " " + exact(actuator.high);
  const std::string changes = changes_text(options.statics.tuning);
  return "softkin map journal 1, softkin " SOFTKIN_VERSION "\nrobot " + fingerprint_of(model) + ranges + "\naccuracy " +
         exact(options.accuracy_mm) + " mm, loads " + exact(options.load_accuracy) + ", ratios " +
         exact(options.ratio_accuracy) + ", shape " + exact(options.shape_accuracy_mm) + " mm; seed " +
         std::to_string(options.seed) + "; solver tolerance " + exact(options.statics.step_tolerance_mm) +
         " mm, iterations " + std::to_string(options.statics.iteration_limit()) +
         (options.statics.stable ? ", stable" : "") + (changes.empty() ? "" : ", options " + changes) + "\n";
}

}  // namespace

std::filesystem::path MapJournal::path_of(const std::filesystem::path& map) {
  return journal_of(map);
}

MapJournal::MapJournal(const std::filesystem::path& map, const Model& model, const MapOptions& options, bool resume) {
  const std::filesystem::path path = path_of(map);
  if (!resume && std::filesystem::exists(path))
    throw InvalidInput({path.string()},
                       "is what an unfinished map has found so far: add --resume to go on with it, or remove it");
  const std::string head = journal_head(model, options);
  store_.emplace(path, head, resume);
  if (store_->head() != head)
    throw InvalidInput({path.string()},
                       "cannot be gone on with: it is of another robot, or was begun with other options");
  store_->each([&](std::size_t, std::string_view record) {
    std::istringstream line{std::string(record)};
    Index piece = 0, number = 0;
    std::string text;
    try {
      if (!(line >> piece >> number >> text)) throw InvalidInput("a record is broken");
      known_[{piece, number}] = unpacked_sample(from_base64(text));
    } catch (const InvalidInput& error) {
      throw InvalidInput({path.string()}, std::string("cannot be gone on with: ") + error.what());
    }
    return true;
  });
}

std::optional<maps::Sample> MapJournal::known(Index piece, Index number, const Eigen::VectorXd& commands) {
  const auto found = known_.find({piece, number});
  if (found == known_.end() || found->second.commands != commands) return std::nullopt;
  return found->second;
}

void MapJournal::keep(Index piece, Index number, const maps::Sample& sample) {
  store_->append(std::to_string(piece) + " " + std::to_string(number) + " " + to_base64(packed_sample(sample)));
}

void MapJournal::remove() {
  store_->remove();
}

}  // namespace softkin::runs
