#pragma once

#include <optional>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <softkin/runs/jobs.hpp>
#include <softkin/runs/page_document.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace softkin::runs {

/// The page of apps/view/web as it was built, and of it what exported maps run; empty where they were not.
[[nodiscard]] std::string_view embedded_page();
[[nodiscard]] std::string_view embedded_map_script();
[[nodiscard]] inline bool page_is_there() {
  return !embedded_page().empty();
}

inline constexpr const char* no_page = "this softkin was built without its page; npm, or its registry, was not there";

/// Why no page can be written into a file of that name, also where softkin was built without its page; empty: it can.
[[nodiscard]] std::string page_refusal(const std::string& file);

/// A page with what it shows in <script type="application/json" id="softkin-page">, where no text of it can end that.
///
/// throws  InvalidInput where the page has no such element, or several
[[nodiscard]] std::string page_html(std::string_view page, std::string_view document);

/// Words as a shell takes them: quoted where they need it.
[[nodiscard]] std::string command_line(const std::vector<std::string>& words);

/// What the user typed, program first, for the pages of this process; "" until it is kept.
void keep_command(std::vector<std::string> words);
[[nodiscard]] const std::string& kept_command();

/// The content of a page that compares results, without a robot.
struct Comparison {
  std::vector<std::string> notes;                     // a line each
  std::vector<std::pair<std::string, Table>> tables;  // with their captions
  Plot plot;
};

/// Writes the page of a comparison. command: the line that makes it. Returns the text of RunPage::reported().
std::string write_comparison_page(const std::string& file, const Comparison& comparison, const std::string& command);

/// A page that is written once all its content is available.
class RunPage {
 public:
  /// All must outlive the object. file: empty: there is no page; command: the line that makes it, for people
  RunPage(std::string file, const Model& model, std::string command);

  /// Takes the records that the run makes and takes over; before the first of them. statics: knows what presses on what
  /// in those taken over; null: their pages do not show it
  template <class Record>
  void watch(Run<Record>& run, const Statics* statics) {
    if (!document_) return;
    run.watch([this, statics](const Record& record, const Points& positions, const ElementDeformation* made) {
      add(record, positions, made, statics);
    });
  }
  /// The map to bend the robot by; null: none. It must outlive write().
  void bend_by(const MapData* map) { map_ = map; }
  /// Where a marker gets, #samples by 3 [mm].
  void show_reach(Index marker, const Points& positions);

  /// Into the file; nothing where there is nothing but the robot at rest.
  void write();
  /// "page: F.html (2.1 MB; open it in a browser)"; empty where none was written.
  [[nodiscard]] std::string reported() const;

 private:
  void add(const StepRecord& record, const Points& positions, const ElementDeformation* made, const Statics* statics);

  std::string file_;
  const Model& model_;
  std::optional<PageDocument> document_{};
  const MapData* map_ = nullptr;
  bool reaches_ = false;
  std::size_t bytes_ = 0;
};

}  // namespace softkin::runs
