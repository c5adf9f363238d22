#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/table.hpp>

namespace softkin {
namespace {

namespace fs = std::filesystem;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Words, a number, a count and words again.
Table sample() {
  return {{{.key = "name", .left = true},
           {.key = "tip_x_mm", .title = "tip x", .unit = "mm", .digits = 2, .form = Column::Form::decimals},
           {.key = "steps"},
           {.key = "status", .left = true}},
          {{"Gelenk ü", 1.0 / 3, std::int64_t{7}, "converged"}, {"b", -20.0, std::int64_t{12345678}, ""}}};
}

TEST(Table, TextIsAlignedByCharactersNotBytes) {
  EXPECT_EQ(sample().lines(),
            (std::vector<std::string>{"name      tip x [mm]     steps  status",
                                      "Gelenk ü        0.33         7  converged", "b             -20.00  12345678"}));
}

TEST(Table, ATableThatIsTooWideIsTurnedOnItsSide) {
  EXPECT_EQ(sample().lines(41), sample().lines());
  EXPECT_EQ(sample().lines(40), (std::vector<std::string>{"name        Gelenk ü", "tip x [mm]  0.33", "steps       7",
                                                          "status      converged", "", "name        b",
                                                          "tip x [mm]  -20.00", "steps       12345678"}));
  EXPECT_EQ((Table{sample().columns}.lines(10).size()), 1U) << "no rows: the titles";
}

TEST(Table, BodyLeavesTheTitlesOut) {
  EXPECT_EQ(sample().body(), (std::vector<std::string>{"Gelenk ü    0.33         7  converged",  //
                                                       "b         -20.00  12345678"}));
  EXPECT_TRUE((Table{sample().columns}.body().empty()));
  EXPECT_EQ((Table{sample().columns}.lines().size()), 1U);
}

TEST(Table, RowsThatComeOneByOneAreAsWideAsTitleOrWidth) {
  const Table table{
      {{.title = "µm", .width = 1}, {.title = "t", .digits = 3, .width = 6}, {.title = "end", .left = true}}};
  EXPECT_EQ(table.header(), "µm       t  end");
  EXPECT_EQ(table.line({std::int64_t{1}, 2.34567, "ok"}), " 1    2.35  ok");
  EXPECT_EQ(table.line({std::int64_t{12345}, -1e-9, "wider than its title"}), "12345  -1e-09  wider than its title");
}

TEST(Table, WhatIsNotKnownIsSaidAndWhatDoesNotApplyIsNot) {
  const Table table{{{.key = "a"}, {.key = "b"}, {.key = "c"}}, {{unknown, Cell(), -0.0}, {HUGE_VAL, Cell(), 1.0}}};
  EXPECT_EQ(table.body(), (std::vector<std::string>{"unknown    0", "unknown    1"}));
  EXPECT_EQ(table.csv(), "a,b,c\n,,-0\n,,1\n");
  const auto json = nlohmann::json::parse(table.json());
  ASSERT_EQ(json.size(), 2U);
  for (const auto& row : json) {
    EXPECT_TRUE(row.at("a").is_null());
    EXPECT_TRUE(row.at("b").is_null());
    EXPECT_TRUE(row.at("c").is_number());
  }
}

TEST(Table, CsvQuotesWhatWouldReadOtherwise) {
  const Table table{{{.key = "plain"}, {.key = "with, comma"}},
                    {{"a b", "say \"no\""}, {"two\nlines", "x,y"}, {"", "end\r"}}};
  EXPECT_EQ(table.csv(), "plain,\"with, comma\"\na b,\"say \"\"no\"\"\"\n\"two\nlines\",\"x,y\"\n,\"end\r\"\n");
}

TEST(Table, NumbersOfCsvReadBackAsTheyWere) {
  const std::vector<double> values{1.0 / 3, -1e-300, 12345678901234.5, 0.1, 5e-324, -0.0};
  Table table{{{.key = "a", .digits = 2}, {.key = "b"}}};
  for (const double value : values) table.rows.push_back({value, -value});
  const fs::path file = fs::temp_directory_path() / ("softkin_table_" + std::to_string(::getpid()) + ".csv");
  write_file(file, table.csv());
  const CsvTable read = read_csv(file);
  fs::remove(file);
  EXPECT_EQ(read.columns, (std::vector<std::string>{"a", "b"}));
  ASSERT_EQ(read.rows.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(read.rows[i], (std::vector<double>{values[i], -values[i]}));
}

TEST(Table, JsonKeepsKeysInOrderAndTypes) {
  EXPECT_EQ(nlohmann::ordered_json::parse(sample().json()).dump(),
            "[{\"name\":\"Gelenk ü\",\"tip_x_mm\":0.3333333333333333,\"steps\":7,\"status\":\"converged\"},"
            "{\"name\":\"b\",\"tip_x_mm\":-20.0,\"steps\":12345678,\"status\":\"\"}]");
  EXPECT_EQ((Table{sample().columns}.json()), "[]");
}

TEST(Table, ARowThatIsTooShortIsRefused) {
  Table table = sample();
  table.rows.push_back({"c"});
  EXPECT_THROW((void)table.lines(), std::out_of_range);
  EXPECT_THROW((void)table.csv(), std::out_of_range);
  EXPECT_THROW((void)table.json(), std::out_of_range);
}

}  // namespace
}  // namespace softkin
