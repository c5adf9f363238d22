#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <softkin/core/error.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/csv.hpp>

namespace softkin {
namespace {

namespace fs = std::filesystem;

class Csv : public ::testing::Test {
 protected:
  Csv() : folder_(fs::temp_directory_path() / ("softkin_csv_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  ~Csv() override { fs::remove_all(folder_); }

  CsvTable read(const std::string& content) {
    const fs::path file = folder_ / "table.csv";
    std::ofstream(file, std::ios::binary) << content;
    return read_csv(file);
  }

  void expect_refused(const std::string& content, const std::string& place, const std::string& fragment) {
    SCOPED_TRACE(content);
    try {
      (void)read(content);
      ADD_FAILURE() << "not refused";
    } catch (const InvalidInput& error) {
      const std::string message = error.what(), start = (folder_ / "table.csv").string() + place + ": ";
      EXPECT_EQ(message.substr(0, start.size()), start) << message;
      EXPECT_NE(message.find(fragment), std::string::npos) << message;
      EXPECT_EQ(find_unprintable(message), std::string::npos) << message;
    }
  }

  fs::path folder_;
};

TEST_F(Csv, ReadsColumnsRowsAndLines) {
  const CsvTable table = read("# exported\n\n t_s , air,tendon\n0,1,\t1\n# half way\n\n 0.5 ,1.25e0,+0.75\n1,.5,-3");
  EXPECT_EQ(table.columns, (std::vector<std::string>{"t_s", "air", "tendon"}));
  EXPECT_EQ(table.rows, (std::vector<std::vector<double>>{{0, 1, 1}, {0.5, 1.25, 0.75}, {1, 0.5, -3}}));
  EXPECT_EQ(table.lines, (std::vector<std::size_t>{4, 7, 8}));
}

TEST_F(Csv, AcceptsWindowsLineEndsAndByteOrderMark) {
  const CsvTable table = read("\xEF\xBB\xBFt_s,winkel_\xC2\xB0\r\n1,2\r\n\r\n3,4\r\n");
  EXPECT_EQ(table.columns, (std::vector<std::string>{"t_s", "winkel_\xC2\xB0"}));
  EXPECT_EQ(table.rows, (std::vector<std::vector<double>>{{1, 2}, {3, 4}}));
  EXPECT_EQ(table.lines, (std::vector<std::size_t>{2, 4}));
  EXPECT_EQ(read("\xEF\xBB\xBF# note\na\n1\n").columns, std::vector<std::string>{"a"});
}

TEST_F(Csv, CommentsMayHoldAnything) {
  EXPECT_EQ(read("# \"quoted\" \xFF\x01\na\n  # \"\n1\n").rows, (std::vector<std::vector<double>>{{1}}));
}

TEST_F(Csv, RefusesBadHeaders) {
  expect_refused("", "", "has no header");
  expect_refused("# only a comment\n\n", "", "has no header");
  expect_refused("0,1\n2,3\n", ":1", "the header is missing: '0,1'");
  expect_refused("a,,b\n1,2,3\n", ":1", "column 2 of the header has no name");
  expect_refused("a,b,\n1,2,3\n", ":1", "column 3 of the header has no name");
  expect_refused("\na, b ,a\n1,2,3\n", ":2", "column 'a' appears twice");
  expect_refused("a,b\n", ":1", "no row follows the header");
  expect_refused("a\r1\r2\r", ":1", "lines end with LF or CRLF");
  expect_refused("a,\xB0\n1,2\n", ":1", "not UTF-8");
  expect_refused(
      "t_s;air\n0;1,5\n", ":1",
      "the header 't_s;air' has semicolons: separate the cells by commas, and write numbers with a decimal point");
  expect_refused(std::string("a\0,b\n1,2\n", 9), ":1", "control characters");
}

TEST_F(Csv, RefusesBadRows) {
  expect_refused("a,b\n1,2\n\n1\n", ":4", "the row has 1 cells, the header 2 columns");
  expect_refused("a,b\n1,2,3\n", ":2", "the row has 3 cells");
  expect_refused("a,b\n1,5,2,5\n", ":2", "2 columns; a number is written with a decimal point, not a comma");
  expect_refused("a,b\n1,\n", ":2", "column 'b' must hold a finite number, not ''");
  expect_refused("a,b\n1,nan\n", ":2", "column 'b' must hold a finite number, not 'nan'");
  expect_refused("a,b\n-inf,1\n", ":2", "column 'a' must hold a finite number, not '-inf'");
  expect_refused("a,b\n1e999,1\n", ":2", "not '1e999'");
  expect_refused("a,b\n1 2,1\n", ":2", "not '1 2'");
  expect_refused("a,b\n0x10,1\n", ":2", "not '0x10'");
  expect_refused("a;b\n1;2\n", ":1", "the header 'a;b' has semicolons");
  expect_refused("a\n1;2\n", ":2", "cells are separated by commas");
  expect_refused("a,b\n1,\xFF\x02\n", ":2", "not '\?\?'");
  expect_refused("a,b\n1,2\n\"3\",4\n", ":3", "quotes are not supported");
  expect_refused("\"a\",b\n1,2\n", ":1", "quotes are not supported");
}

TEST_F(Csv, RefusesFilesThatAreNotThere) {
  EXPECT_THROW((void)read_csv(folder_ / "none.csv"), InvalidInput);
  EXPECT_THROW((void)read_csv(folder_), InvalidInput);
}

TEST(PlainText, FindsWhatIsNotText) {
  EXPECT_EQ(find_unprintable("plain \t\r\n \xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80"), std::string::npos);
  EXPECT_EQ(find_unprintable("ab\x01"), 2u);
  EXPECT_EQ(find_unprintable("ab\x7F"), 2u);
  EXPECT_EQ(find_unprintable("\xC0\xAF"), 0u);           // overlong
  EXPECT_EQ(find_unprintable("a\xE0\x80\x80"), 1u);      // overlong
  EXPECT_EQ(find_unprintable("a\xED\xA0\x80"), 1u);      // surrogate
  EXPECT_EQ(find_unprintable("a\xF4\x90\x80\x80"), 1u);  // above U+10FFFF
  EXPECT_EQ(find_unprintable("a\xE2\x82"), 1u);          // cut
  EXPECT_EQ(find_unprintable("a\x80"), 1u);              // continuation alone
}

TEST(PlainText, ExcerptsAreShortAndPrintable) {
  EXPECT_EQ(excerpt("abc"), "'abc'");
  EXPECT_EQ(excerpt("a\nb\x01"), "'a?b?'");
  EXPECT_EQ(excerpt("\xC3\xA9"), "'\xC3\xA9'");
  EXPECT_EQ(excerpt("\xC3"), "'?'");
  const std::string cut = excerpt(std::string(59, 'x') + "\xC3\xA9" + "tail");
  EXPECT_EQ(cut, "'" + std::string(59, 'x') + "...'");
}

}  // namespace
}  // namespace softkin
