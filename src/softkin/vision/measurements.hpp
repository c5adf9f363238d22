#pragma once

#include <memory>
#include <softkin/io/table/table.hpp>
#include <softkin/vision/measurer.hpp>
#include <softkin/vision/pictures.hpp>
#include <string>
#include <vector>

namespace softkin::vision {

/// Photographs that are measured one after another; the first one is the rest of specimens and angles.
class PhotoSeries {
 public:
  /// Throws as understood().
  explicit PhotoSeries(const MeasureOptions& options) : measurer_(understood(options), false) {}

  struct Photo {
    std::string file;
    Measurer::Seen seen;
  };

  /// Throws InvalidInput that begins with file.
  void add(const RgbImage& picture, const std::string& file) {
    photos_.push_back({file, measurer_.measure(picture, file)});
  }

  [[nodiscard]] const std::vector<Photo>& photos() const { return photos_; }
  [[nodiscard]] const Measurer& measurer() const { return measurer_; }
  [[nodiscard]] bool has_specimen() const { return !photos_.empty() && photos_[0].seen.specimen.has_value(); }
  [[nodiscard]] bool has_outlines() const { return !photos_.empty() && photos_[0].seen.outline.has_value(); }
  /// Of the specimen, the photographs after the first against it.
  [[nodiscard]] std::vector<Stretch> stretches() const;

  // Of one photograph at least.

  /// Markers and angles, a row for each photograph; of a specimen its lengths, a row for each stretch; of outlines
  /// their points: docs/measure.md.
  [[nodiscard]] Table table() const;
  /// The same as the content of a file, with what it was measured from as comments.
  [[nodiscard]] std::string csv() const;
  /// Everything, JSON; its keys name the units.
  [[nodiscard]] std::string json() const;

  // What is printed:

  [[nodiscard]] Table shown_markers() const;
  [[nodiscard]] Table shown_angles() const;
  [[nodiscard]] Table shown_specimens() const;
  [[nodiscard]] Table shown_stretches() const;
  [[nodiscard]] Table shown_outlines() const;

 private:
  Measurer measurer_;
  std::vector<Photo> photos_;
};

/// The track of a film's markers. The first frame must show all of them; a later one that does not is left out, and
/// said to be.
class FilmTrack {
 public:
  /// files, rate  as Film takes them. Throws as understood() and Film
  FilmTrack(const MeasureOptions& options, std::vector<std::filesystem::path> files, std::optional<double> rate);

  /// Measures the next frame; false: there was none. Throws InvalidInput as Film::next, and where the first frame does
  /// not show all.
  [[nodiscard]] bool advance();

  [[nodiscard]] std::size_t frames() const { return frames_; }  // so far
  [[nodiscard]] double fraction() const;                        // of the film; < 0: not known
  [[nodiscard]] double rate() const { return film_.rate(); }
  [[nodiscard]] const Measurer& measurer() const { return measurer_; }
  /// Why each frame is left out.
  [[nodiscard]] const std::vector<std::string>& left_out() const { return left_out_; }
  [[nodiscard]] const std::vector<std::string>& markers() const { return markers_; }

  /// t_s, places [mm] and angles [degrees], a row for each frame that was measured.
  [[nodiscard]] const Table& table() const { return table_; }
  [[nodiscard]] std::string csv() const;
  /// What it is, JSON. output: the table's file
  [[nodiscard]] std::string json(const std::string& output) const;

 private:
  void take(const Measurer::Seen& seen, double time);

  Measurer measurer_;
  Film film_;
  Table table_;
  std::vector<std::string> markers_, left_out_;
  std::size_t frames_ = 0;
};

}  // namespace softkin::vision
