#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/hal/fuzz/fuzz_input.h"

// Replays a corpus and seeded random inputs through a fuzz target without libFuzzer:
//
//   <target>_replay CORPUS_DIRECTORY RANDOM_INPUTS SEED
namespace {

using Bytes = std::vector<std::uint8_t>;

void run(const Bytes& input) { LLVMFuzzerTestOneInput(input.data(), input.size()); }

std::vector<Bytes> read_corpus(const std::filesystem::path& directory) {
  std::vector<Bytes> corpus;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    std::ifstream file(entry.path(), std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return corpus;
}

/// Half of the inputs are random bytes, half a corpus input with a few bytes changed.
Bytes random_input(const std::vector<Bytes>& corpus, std::mt19937_64& random) {
  const auto random_byte = [&random] { return static_cast<std::uint8_t>(random()); };
  if (random() % 2 == 0) {
    Bytes input(random() % 90);
    for (std::uint8_t& byte : input) byte = random_byte();
    return input;
  }
  Bytes input = corpus[random() % corpus.size()];
  for (std::uint64_t changes = 1 + random() % 4; changes > 0 && !input.empty(); --changes) {
    input[random() % input.size()] = random_byte();
  }
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << argv[0] << ": expected a corpus directory, a number of random inputs and a seed\n";
    return 2;
  }
  const std::vector<Bytes> corpus = read_corpus(argv[1]);
  if (corpus.empty()) {
    std::cerr << argv[0] << ": the corpus " << argv[1] << " is empty\n";
    return 1;
  }
  const std::uint64_t seed = std::stoull(argv[3]);
  std::cout << "corpus " << corpus.size() << " inputs, then " << argv[2] << " random ones, seed " << seed
            << '\n'
            << std::flush;
  for (const Bytes& input : corpus) run(input);
  std::mt19937_64 random(seed);
  for (std::uint64_t left = std::stoull(argv[2]); left > 0; --left) run(random_input(corpus, random));
  return 0;
}
