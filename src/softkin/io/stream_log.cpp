#include <cerrno>
#include <cstring>
#include <ctime>
#include <softkin/core/error.hpp>
#include <softkin/io/stream_log.hpp>

namespace softkin {

StreamLog::StreamLog(const std::string& path, std::function<void(const std::string&)> failed)
    : file_(std::fopen(path.c_str(), "w"), std::fclose), failed_(std::move(failed)) {
  if (!file_) throw InvalidInput({path}, std::strerror(errno));
}

void StreamLog::add(char kind, std::string text) {
  while (text.starts_with("\n")) text.erase(0, 1);
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = '?';
  const auto time = std::chrono::system_clock::now();
  const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch()).count() % 1000;
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begin_;
  std::tm utc = {};
  ::gmtime_r(&seconds, &utc);
  char day[40];
  std::strftime(day, sizeof day, "%Y-%m-%dT%H:%M:%S", &utc);
  std::fprintf(file_.get(), "%s.%03dZ %10.3f s %c %s\n", day, static_cast<int>(ms), since.count(), kind, text.c_str());
  if (std::fflush(file_.get()) == 0 || !failed_) return;
  failed_(std::strerror(errno));
  failed_ = {};
}

}  // namespace softkin
