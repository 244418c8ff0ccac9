// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "bench/scenario/reading/keys.hpp"
#include "bench/scenario/signals/signals.hpp"
#include "tests/places/places.hpp"

namespace servogate::scenario {
namespace {

void published(const std::string& name, const std::string& content) {
  const std::string path = tests::source_dir() + "/" + name;
  if (std::getenv("SERVOGATE_UPDATE") != nullptr) std::ofstream(path, std::ios::binary) << content;
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), content) << path << ": SERVOGATE_UPDATE=1 writes it anew";
}

std::string signals(bool russian) {
  std::string out = russian ? "| сигнал | единица | смысл |\n|---|---|---|\n"
                            : "| signal | unit | meaning |\n|---|---|---|\n";
  for (const QuantityRow& row : quantities()) {
    std::string names;
    for (const char c : std::string(row.name))
      names += c == ',' ? std::string("`,") : c == ' ' ? " `" : std::string(1, c);
    out += "| `" + names + "` | " + std::string(row.unit) + " | " +
           std::string(russian ? row.russian : row.english) + " |\n";
  }
  return out;
}

TEST(PublishedFiles, schema_is_what_the_reader_reads) {
  published("docs/scenario.schema.json", json_schema());
}

TEST(PublishedFiles, reference_has_every_key_word_and_signal) {
  published("docs/scenario-reference.md",
            "# Scenario files: keys, words, signals\n\nMade from the tables of the reader "
            "(`bench/scenario`); do not edit. How they are used: "
            "[testing.md](testing.md).\n\n## Keys\n" +
                key_reference(false) + "\n## Words of `do`\n\n" + word_reference(false) +
                "\n## Signals\n\nNames of the machine: every point and symbol of the machine file, places "
                "(`SA16`, `SK10.IN`), words of "
                "the interface ([interface.md](interface.md)) and elementary variables of the PLC "
                "(`main.counter`). Beside them, here with "
                "axis X and bus `can`:\n\n" +
                signals(false));
  published("docs/ru/scenario-reference.md",
            "# Файлы сценариев: ключи, слова, сигналы\n\nСоздано из таблиц читателя (`bench/scenario`); не "
            "править. Применение: "
            "[testing.md](testing.md).\n\n## Ключи\n" +
                key_reference(true) + "\n## Слова `do`\n\n" + word_reference(true) +
                "\n## Сигналы\n\nИмена станка: каждая точка и символ файла станка, места (`SA16`, "
                "`SK10.IN`), слова интерфейса "
                "([interface.md](../interface.md)) и простые переменные ПЛК (`main.counter`). Кроме них, "
                "здесь для оси X и шины `can`:\n\n" +
                signals(true));
}

}  // namespace
}  // namespace servogate::scenario
