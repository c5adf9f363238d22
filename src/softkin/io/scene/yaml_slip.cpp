#include <softkin/io/scene/yaml_slip.hpp>
#include <vector>

namespace softkin::scene {

namespace {

char closing(char bracket) {
  return bracket == '{' ? '}' : ']';
}

std::string shown(char c) {
  return std::string("'") + c + "'";
}

/// Goes through the text with what is open where.
class SlipFinder {
 public:
  explicit SlipFinder(const std::string& text) : text_(text) {}

  std::optional<YamlSlip> find() {
    for (at_ = 0; at_ < text_.size() && !slip_; ++at_) step(text_[at_]);
    if (!slip_ && quote_ != 0)
      slip_ = {quote_line_, std::string("the quote ") + quote_ + " that begins here is never closed"};
    if (!slip_ && !open_.empty())
      slip_ = {open_.back().line, "the " + shown(open_.back().bracket) + " here is never closed: a " +
                                      shown(closing(open_.back().bracket)) + " is missing"};
    return slip_ ? slip_ : tab_;
  }

 private:
  struct Open {
    char bracket;
    std::size_t line;
  };

  void step(char c) {
    if (c == '\n') {
      ++line_;
      before_ = '\n';
      return;
    }
    if (quote_ != 0) return in_quote(c);
    const bool starts = before_ == '\n' || before_ == 0 || std::string(":,[{-?").find(before_) != std::string::npos;
    if (c == '\t' && before_ == '\n' && open_.empty() && !tab_)
      tab_ = {line_, "this line is indented with a tab; YAML takes spaces"};
    if (c == ' ' || c == '\t' || c == '\r') return;
    if (c == '#' && (at_ == 0 || text_[at_ - 1] == ' ' || text_[at_ - 1] == '\t' || text_[at_ - 1] == '\n')) {
      while (at_ + 1 < text_.size() && text_[at_ + 1] != '\n') ++at_;
      return;
    }
    if ((c == '"' || c == '\'') && starts) {
      quote_ = c;
      quote_line_ = line_;
    } else if ((c == '{' || c == '[') && (starts || !open_.empty())) {
      open_.push_back({c, line_});
    } else if ((c == '}' || c == ']') && (starts || !open_.empty())) {
      close(c);
    }
    before_ = c;
  }

  void in_quote(char c) {
    if (quote_ == '"' && c == '\\') {
      ++at_;
      return;
    }
    if (c != quote_) return;
    if (quote_ == '\'' && at_ + 1 < text_.size() && text_[at_ + 1] == '\'') {
      ++at_;
      return;
    }
    quote_ = 0;
    before_ = c;
  }

  void close(char c) {
    if (open_.empty()) {
      slip_ = {line_, "the " + shown(c) + " here closes nothing"};
    } else if (closing(open_.back().bracket) != c) {
      slip_ = {open_.back().line, "the " + shown(open_.back().bracket) + " here is closed by " + shown(c) +
                                      " in line " + std::to_string(line_)};
    } else {
      open_.pop_back();
    }
  }

  const std::string& text_;
  std::size_t at_ = 0, line_ = 1, quote_line_ = 0;
  char before_ = '\n';  // the last character but blanks
  char quote_ = 0;      // that is open; 0: none
  std::vector<Open> open_;
  std::optional<YamlSlip> slip_, tab_;
};

}  // namespace

std::optional<YamlSlip> find_slip(const std::string& text) {
  return SlipFinder(text).find();
}

}  // namespace softkin::scene
