#include <softkin/io/mesh/vtk.hpp>

#include "io/vtk_files.hpp"

namespace softkin {
namespace {

using namespace vtk_files;
using Format = XmlForm::Format;

Mesh read_xml(const std::string& content) {
  const TempFolder folder;
  return read_vtu(folder.write("mesh.vtu", content));
}

TEST(VtkXml, ReadsEveryForm) {
  int forms = 0;
  for (const Format format : {Format::ascii, Format::binary, Format::raw, Format::base64})
    for (const bool compressed : {false, true})
      for (const bool big : {false, true})
        for (const bool long_header : {false, true})
          for (const bool narrow : {false, true}) {
            SCOPED_TRACE(::testing::Message() << "format " << static_cast<int>(format) << " compressed " << compressed
                                              << " big " << big << " long " << long_header << " narrow " << narrow);
            expect_reference_mesh(
                read_xml(xml_file({format, big, long_header, compressed, false, narrow, !narrow, 40})));
            ++forms;
          }
  EXPECT_EQ(forms, 64);
}

TEST(VtkXml, ReadsHeadersThatAreEncodedByThemselves) {
  for (const Format format : {Format::binary, Format::base64})
    for (const bool long_header : {false, true})
      expect_reference_mesh(read_xml(xml_file({format, false, long_header, false, true})));
}

TEST(VtkXml, ReadsBlocksWithoutPartialOne) {
  for (const std::size_t block : {std::size_t{1}, std::size_t{8}, std::size_t{192}, std::size_t{100000}})
    expect_reference_mesh(read_xml(xml_file({Format::raw, false, true, true, false, false, true, block})));
}

TEST(VtkXml, ReadsInformationKeysAndWrappedBase64) {
  std::string file = xml_file({Format::binary});
  file = replaced(file, "\n</DataArray>",
                  "\n<InformationKey name=\"L2_NORM_RANGE\" location=\"vtkDataArray\" length=\"2\"><Value index=\"0\">0"
                  "</Value></InformationKey>\n</DataArray>");
  const std::size_t data = file.find("  ", file.find("format=\"binary\""));
  file.insert(data + 9, "\n   ");
  file.insert(data + 30, "\r\n");
  expect_reference_mesh(read_xml(file));
}

TEST(VtkXml, RefusesToUnpackWhatIsNoMesh) {
  const TempFolder folder;
  XmlForm form{Format::raw};
  form.long_header = form.compressed = true;
  form.block = 1 << 20;
  XmlWriter writer(form);
  constexpr std::size_t points = 3'000'000;  // zeros: 72 MB of them in 70 kB
  std::string xml =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
      std::to_string(points) + "\" NumberOfCells=\"0\">\n<Points>\n" +
      writer.array("Float64", "Points", 3, std::vector<double>(3 * points, 0.0)) +
      "</Points>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_" + writer.appended +
      "\n</AppendedData>\n</VTKFile>\n";
  const std::string file = folder.write("bomb.vtu", xml);
  ASSERT_LT(xml.size(), 200'000u);
  const std::string why = refusal([&] { (void)read_vtu_points(file); });
  EXPECT_NE(why.find("unpacks to 72000000 bytes, which makes more than a hundred times the file's size"),
            std::string::npos)
      << why;
}

TEST(VtkXml, ReadsPointsAlone) {
  const TempFolder folder;
  const Points points = read_vtu_points(folder.write("a.vtu", xml_file({Format::raw, true, true, true})));
  ASSERT_EQ(points.rows(), 8);
  for (int i = 0; i < 24; ++i) EXPECT_EQ(points(i / 3, i % 3), kPoints[i]);
}

/// `names`: what the field data hold.
void expect_named_regions(const std::string& names) {
  std::string file = replaced(xml_file({}), "<Piece", "<FieldData>\n" + names + "</FieldData>\n<Piece");
  file = replaced(file, "Name=\"material\"", "Name=\"region\"");
  const std::size_t begin = file.find('\n', file.find("Name=\"region\"")) + 1;
  file.replace(begin, file.find("</DataArray>", begin) - begin, "0 1 1 1 -1 -1 -1 ");
  const Mesh mesh = read_xml(file);
  EXPECT_EQ(region_names(mesh), (std::vector<std::string>{"body", "\xC3\xA4 b", "\xC3\xA4 b_2d"}));
  EXPECT_EQ(region(mesh, "body").prisms, std::vector<Index>{0});
  EXPECT_EQ(region(mesh, "\xC3\xA4 b").tetrahedra, (std::vector<Index>{0, 1}));
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_TRUE(mesh.quads.empty());
}

TEST(VtkXml, NamesRegionsAsTheFileDoes) {
  expect_named_regions(
      "<DataArray type=\"Int64\" Name=\"region_\xC3\xA4 b\" NumberOfTuples=\"1\" format=\"ascii\">1</DataArray>\n"
      "<DataArray type=\"Float64\" Name=\"region_size\" NumberOfTuples=\"1\" format=\"ascii\">2.5</DataArray>\n"
      "<DataArray type=\"Int32\" Name=\"region_sizes\" NumberOfTuples=\"2\" format=\"ascii\">3 4</DataArray>\n"
      "<DataArray type=\"Int32\" Name=\"region_body\" NumberOfTuples=\"1\" format=\"ascii\"> 0 </DataArray>\n");
}

TEST(VtkXml, NamesRegionsByTheStringsOfOlderFiles) {
  expect_named_regions(
      "<Array type=\"String\" Name=\"region_names\" NumberOfTuples=\"3\" "
      "format=\"ascii\">\n98 111 100 121 0\n-61 -92 32 98 0\n99 0\n</Array>\n");
}

}  // namespace
}  // namespace softkin
