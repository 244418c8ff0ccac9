// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/sdo_request.hpp"

#include "gateway/cli/messages.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway::command {
namespace {

using canopen::address_text;
using canopen::encode_value;
using canopen::ObjectCatalogue;
using canopen::type_named;
using canopen::type_words;

const text::Entry kBadObject{
    "sdo.bad-object",
    "'{0}' is no object; expected INDEX[:SUB], hexadecimal: 6041, 1018:4, or a name: "
    "statusword",
    "«{0}» — не объект; нужно INDEX[:SUB] в шестнадцатеричном виде: 6041, 1018:4, или "
    "имя: statusword"};
const text::Entry kSeveral{"sdo.several", "'{0}' is the name of no single object: {1}",
                           "«{0}» — имя не одного объекта: {1}"};
const text::Entry kNoType{
    "sdo.no-type", "the type of {0} is not known here: say it ({1}), or name a data sheet with --eds",
    "тип объекта {0} здесь неизвестен: укажите его ({1}) или файл описания через --eds"};
const text::Entry kBadValue{"sdo.bad-value", "'{0}' is no value of the type {1}",
                            "«{0}» — не значение типа {1}"};
const text::Entry kEmpty{"sdo.empty", "only a text or bytes (str, hex) may be empty",
                         "пустыми бывают только текст и байты (str, hex)"};
const text::Entry kNoValue{"sdo.no-value", "`servogate sdo write` needs a value for {0}",
                           "для `servogate sdo write` нужно значение объекта {0}"};
const text::Entry kNoObject{"sdo.no-object", "`servogate sdo {0}` needs an object behind it",
                            "после `servogate sdo {0}` нужен объект"};
const text::Entry kAnyway{"sdo.anyway", "--anyway is for reading: a write needs a bus without a master",
                          "--anyway — для чтения: запись требует шины без ведущего"};

bool wrong(const text::Entry& entry, const std::vector<std::string>& arguments) {
  complain(entry, arguments);
  return false;
}

bool is_action(const std::string& word) { return word == "read" || word == "write"; }

bool read_value(const std::string& word, SdoRequest& request) {
  if (word.starts_with('@')) {
    std::string why;
    const auto bytes = files::read_file(word.substr(1), files::kMostOfSource, why);
    if (!bytes) return wrong(kCannotRead, {word.substr(1), why});
    request.data.assign(bytes->begin(), bytes->end());
  } else {
    const std::string place = address_text(request.at.index, request.at.subindex);
    if (request.type == nullptr) return wrong(kNoType, {place, type_words()});
    const auto data = encode_value(word, *request.type);
    if (!data) return wrong(kBadValue, {word, std::string(request.type->name)});
    request.data = *data;
  }
  const bool may_be_empty = request.type != nullptr && canopen::eds_type_string(request.type->data_type);
  return !request.data.empty() || may_be_empty || wrong(kEmpty, {});
}

}  // namespace

std::optional<canopen::ObjectAddress> object_of_word(const std::string& word,
                                                     const ObjectCatalogue& catalogue) {
  std::vector<std::string> similar;
  const auto at = catalogue.address(word, &similar);
  if (at) return at;
  std::string names;
  for (const std::string& name : similar) names += (names.empty() ? "" : ", ") + name;
  names.empty() ? complain(kBadObject, {word}) : complain(kSeveral, {word, names});
  return std::nullopt;
}

bool read_sdo_requests(const SdoOptions& options, const ObjectCatalogue& catalogue,
                       std::vector<SdoRequest>& requests) {
  std::vector<std::string> words{options.action, options.object};
  words.insert(words.end(), options.words.begin(), options.words.end());
  std::string action;
  for (std::size_t i = 0; i < words.size();) {
    if (is_action(words[i])) {
      action = words[i++];
      if (i == words.size() || is_action(words[i])) return wrong(kNoObject, {action});
      continue;
    }
    SdoRequest request;
    request.write = action == "write";
    if (request.write && options.anyway) return wrong(kAnyway, {});
    const auto at = object_of_word(words[i++], catalogue);
    if (!at) return false;
    request.at = *at;
    request.name = catalogue.name(at->index, at->subindex);
    request.type = catalogue.type(at->index, at->subindex);
    std::string value;
    if (request.write) {
      if (i == words.size()) return wrong(kNoValue, {address_text(at->index, at->subindex)});
      value = words[i++];
    }
    if (i < words.size())
      if (const auto* type = type_named(words[i])) {
        request.type = type;
        request.type_given = true;
        ++i;
      }
    if (request.write && !read_value(value, request)) return false;
    requests.push_back(std::move(request));
  }
  return true;
}

}  // namespace servogate::gateway::command
