#include <cctype>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>

#include "codegen/model/header_writer.h"
#include "codegen/urdf/urdf_reader.h"

namespace {

constexpr const char* kUsage =
    "usage: stilt_codegen --urdf FILE --shape NAME --out DIR\n"
    "Writes DIR/NAME/{constants,kinematics,node,impact}.h: dynamics and derivatives of all planar robots "
    "with "
    "the links and joints of the robot in FILE.\n";

struct Arguments {
  std::string urdf;
  std::string shape;
  std::string out;
};

Arguments parse(int argc, char** argv) {
  std::map<std::string, std::string> values{{"--urdf", ""}, {"--shape", ""}, {"--out", ""}};
  for (int i = 1; i < argc; i += 2) {
    const auto entry = values.find(argv[i]);
    if (entry == values.end())
      throw std::invalid_argument(std::string("unknown option '") + argv[i] + "'; --help lists them");
    if (i + 1 == argc) throw std::invalid_argument("option " + entry->first + " needs a value");
    entry->second = argv[i + 1];
  }
  for (const auto& [name, value] : values) {
    if (value.empty()) throw std::invalid_argument("option " + name + " is missing; --help shows the usage");
  }
  const std::string& shape = values["--shape"];
  bool identifier = std::isalpha(static_cast<unsigned char>(shape[0])) != 0;
  for (const char c : shape)
    identifier = identifier && (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_');
  if (!identifier)
    throw std::invalid_argument("shape '" + shape + "' must be letters, digits and _, a letter first");
  return {.urdf = values["--urdf"], .shape = shape, .out = values["--out"]};
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    throw std::runtime_error(path.string() + ": cannot be written; give a folder that can be written to.");
}

void generate(const Arguments& arguments) {
  const stilt::codegen::PlanarTree tree = stilt::codegen::read_urdf(arguments.urdf);
  const auto headers = stilt::codegen::write_headers(tree, arguments.urdf, arguments.shape);
  const std::filesystem::path folder = std::filesystem::path(arguments.out) / arguments.shape;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const auto& [name, text] : headers) {
    write_file(folder / name, text);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && (std::string(argv[1]) == "--help" || std::string(argv[1]) == "-h")) {
    std::cout << kUsage;
    return 0;
  }
  try {
    generate(parse(argc, argv));
  } catch (const std::exception& error) {
    std::cerr << "stilt_codegen: " << error.what() << "\n";
    return 2;
  }
  return 0;
}
