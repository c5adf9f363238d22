#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <softkin/core/error.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/measurements.hpp>

namespace softkin {
namespace {

namespace fs = std::filesystem;

class MaterialTables : public ::testing::Test {
 protected:
  MaterialTables() : folder_(fs::temp_directory_path() / ("softkin_material_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  ~MaterialTables() override { fs::remove_all(folder_); }

  fs::path write(const std::string& content) {
    const fs::path file = folder_ / "table.csv";
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }

  template <class Read>
  void expect_refused(const Read& read, const std::string& content, const std::string& place,
                      const std::string& fragment) {
    SCOPED_TRACE(content);
    try {
      (void)read(write(content));
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

TEST_F(MaterialTables, ReadsStretchedSpecimens) {
  const auto found = read_stretched_specimens(
      write("# camera\nl1_mm,l_mm,dl1_mm,dl_mm,force_N,area_mm2\n40,100,0.3,2,68.2,200\n\n60,100,0.5,2,80,201\n"));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].length_mm, 100);
  EXPECT_EQ(found[0].interface_mm, 40);
  EXPECT_EQ(found[0].stretch_mm, 2);
  EXPECT_EQ(found[0].interface_moved_mm, 0.3);
  EXPECT_EQ(found[0].force_n, 68.2);
  EXPECT_EQ(found[0].line, 3u);
  EXPECT_EQ(found[1].area_mm2, 201);
  EXPECT_EQ(found[1].line, 5u);
  const auto plain = read_stretched_specimens(write("l_mm,l1_mm,dl_mm,dl1_mm\n100,40,2,0.3\n"));
  EXPECT_FALSE(plain[0].force_n);
  EXPECT_FALSE(plain[0].area_mm2);
}

TEST_F(MaterialTables, RefusesSpecimensByLineAndUnit) {
  const auto refused = [&](const std::string& content, const std::string& place, const std::string& fragment) {
    expect_refused([](const fs::path& file) { return read_stretched_specimens(file); }, content, place, fragment);
  };
  const std::string head = "l_mm,l1_mm,dl_mm,dl1_mm\n";
  refused("l_mm,l1_mm,dl_cm,dl1_mm\n100,40,0.2,0.3\n", ":1",
          "column 'dl_cm': this is taken in mm, not in 'cm': convert it to 'dl_mm'");
  refused("l_mm,l1_mm,dl_mm,dl1_inch\n100,40,0.2,0.3\n", ":1", "convert it to 'dl1_mm'");
  refused("l_mm,l1_mm,dl_mm,dl1_mm,force_kgf\n100,40,2,0.3,1\n", ":1", "taken in N, not in 'kgf'");
  refused("l_mm,l1_mm,dl_mm,dl1_mm,area_cm2\n100,40,2,0.3,1\n", ":1", "convert it to 'area_mm2'");
  refused("l_mm,l1_mm,dl,dl1_mm\n100,40,2,0.3\n", ":1", "its unit is missing: write 'dl_mm'");
  refused("l_mm,l1_mm,dl_mm\n100,40,2\n", ":1", "column 'dl1_mm' is missing");
  refused("l_mm,l1_mm,dl_mm,dl1_mm,colour\n100,40,2,0.3,1\n", ":1", "column 'colour': there is no such column");
  refused("l_mm,l1_mm,dl_mm,dl1_mm,force_n,force_N\n100,40,2,0.3,1,1\n", ":1", "two columns are 'force_n'");
  refused(head + "100,40,2,0.3\n100,120,2,0.3\n", ":3", "'l1_mm' must be less than 'l_mm', but 120 is not below 100");
  refused(head + "100,40,2,0.3\n# x\n100,40,2,2\n", ":4", "'dl1_mm' must be less than 'dl_mm'");
  refused(head + "100,40,-2,0.3\n", ":2", "'dl_mm' must be greater than 0, not -2");
  refused(head + "100,0,2,0.3\n", ":2", "'l1_mm' must be greater than 0");
  refused(head + "100,40,2,0\n", ":2", "'dl1_mm' must be greater than 0");
  refused(head + "100,40,2,nan\n", ":2", "finite number");
  refused(head + "100,40,2\n", ":2", "3 cells");
  refused("l_mm,l1_mm,dl_mm,dl1_mm,force_n\n100,40,2,0.3,0\n", ":2", "'force_n' must be greater than 0");
}

TEST_F(MaterialTables, ReadsAndRefusesTwistedSpecimens) {
  const auto found = read_twisted_specimens(write("l_mm,l1_mm,twist_deg,interface_deg\n100,50,20,4.4\n"));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].twist_deg, 20);
  EXPECT_EQ(found[0].interface_deg, 4.4);
  EXPECT_FALSE(read_twisted_specimens(write("l_mm,l1_mm,twist_deg\n100,50,20\n"))[0].interface_deg);
  const auto refused = [&](const std::string& content, const std::string& place, const std::string& fragment) {
    expect_refused([](const fs::path& file) { return read_twisted_specimens(file); }, content, place, fragment);
  };
  refused("l_mm,l1_mm,twist_rad\n100,50,0.3\n", ":1", "convert it to 'twist_deg'");
  refused("l_mm,l1_mm,twist_deg\n100,50,200\n", ":2", "'twist_deg' must be at most 180");
  refused("l_mm,l1_mm,twist_deg\n100,50,-20\n", ":2", "'twist_deg' must be greater than 0");
  refused("l_mm,l1_mm,twist_deg,interface_deg\n100,50,20,21\n", ":2", "'interface_deg' must be less than 'twist_deg'");
}

TEST_F(MaterialTables, ReadsATensileTest) {
  const TensileCurve percent =
      read_tensile_curve(write("strain_percent,stress_mpa\n0,0\n1,0.1\n2,0.2\n3,0.3\n4,0.4\n"));
  const TensileCurve plain =
      read_tensile_curve(write("stress_MPa,strain\n0,0\n0.1,0.01\n0.2,0.02\n0.3,.03\n0.4,.04\n"));
  EXPECT_EQ(percent.strain, plain.strain);
  EXPECT_EQ(percent.stress, plain.stress);
  EXPECT_EQ(percent.strain[3], 0.03);
  EXPECT_EQ(percent.lines.back(), 6u);
}

TEST_F(MaterialTables, RefusesTensileTests) {
  const auto refused = [&](const std::string& content, const std::string& place, const std::string& fragment) {
    expect_refused([](const fs::path& file) { return read_tensile_curve(file); }, content, place, fragment);
  };
  const std::string rows = "0,0\n.1,1\n.2,2\n.3,3\n";
  refused("strain,stress_kpa\n" + rows + ".4,4\n", ":1", "column 'stress_kpa': this is taken in MPa, not in 'kpa'");
  refused("strain,stress\n" + rows + ".4,4\n", ":1", "its unit is missing: write 'stress_mpa'");
  refused("strain_mm,stress_mpa\n" + rows + ".4,4\n", ":1", "column 'strain_mm': there is no such column");
  refused("stress_mpa\n1\n", ":1", "a column of the strain is missing");
  refused("strain,strain_percent,stress_mpa\n0,0,0\n", ":1", "two columns are the strain");
  refused("strain,stress_mpa\n" + rows + ".2,4\n", ":6", "must ascend, but 0.2 follows 0.3");
  refused("strain,stress_mpa\n-0.1,0\n" + rows, ":2", "must not be below 0");
  refused("strain,stress_mpa\n" + rows + "40,4\n", ":6", "is it in percent? Then name the column 'strain_percent'");
  refused("strain,stress_mpa\n" + rows, "", "at least five rows, not 4");
  refused("strain,stress_mpa\n0,0\n.1,-1\n.2,-2\n.3,-3\n.4,-4\n", "", "tension counts positive");
  refused("strain,stress_mpa\n0,0\n.1,x\n", ":3", "finite number");
}

}  // namespace
}  // namespace softkin
