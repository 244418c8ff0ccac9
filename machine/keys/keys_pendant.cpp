// SPDX-License-Identifier: Apache-2.0
#include "machine/keys/key.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

template <>
const Section& section_of<PendantConfig>() {
  using C = PendantConfig;
  static const Key keys[] = {
      key<&C::name>("name", {.required = true}, "name of the pendant, in messages",
                    "имя пульта, в сообщениях"),
      key<&C::device>("device", {.required = true, .refers = Refers::device}, "device file without .toml",
                      "файл устройства без .toml"),
      key<&C::url>("url", {.required = true},
                   "mock:NAME; hid:any, the first one of its kind; hid:SERIAL; hid:/dev/hidraw0",
                   "mock:ИМЯ; hid:any — первый такого вида; hid:СЕРИЙНЫЙ_НОМЕР; hid:/dev/hidraw0"),
      key<&C::axes>("axes", {}, "letters of the axes that it may move; none: all that programs move",
                    "буквы осей, которые он может двигать; нет: все, которыми движут программы"),
      key<&C::max_step>("max_step", {.unit = Unit::mm, .min = 0, .max = 10, .above_min = true},
                        "longest way for one count of its wheel, in degrees for a rotary axis; a longer step "
                        "of the pendant is shortened to it",
                        "наибольший путь на один импульс маховичка, для круговой оси в градусах; более "
                        "крупный шаг пульта уменьшается до него"),
      key<&C::dead_man>("dead_man", {}, "button of the pendant without which nothing begins to move",
                        "кнопка пульта, без удержания которой движение не начинается"),
      key<&C::dead_man_point>("dead_man_point", {.refers = Refers::digital_input},
                              "input point without which nothing begins to move: a wired enabling button, "
                              "a mode switch",
                              "вход, без которого движение не начинается: проводная кнопка разрешения, "
                              "переключатель режима"),
      key<&C::buttons>("buttons", {},
                       "meanings of buttons instead of those of the device file: \"macro10: mdi M8\"",
                       "назначения кнопок вместо указанных в файле устройства: \"macro10: mdi M8\""),
  };
  static const Section section{"a hand-held pendant", "выносной пульт", keys, &default_object<C>};
  return section;
}

template <>
const Section& section_of<PathWheelConfig>() {
  using C = PathWheelConfig;
  static const Key keys[] = {
      key<&C::source>("source", {.required = true},
                      "handwheel1 or handwheel2, a counter of the PLC; or the name of a pendant",
                      "handwheel1 или handwheel2 — счётчик ПЛК; либо имя пульта"),
      key<&C::process>("process", {.min = 1, .max = image::kMaxProcesses},
                       "whose programs it drives along their path",
                       "процесс, программы которого он ведёт по контуру"),
      key<&C::full_speed>(
          "full_speed", {.unit = Unit::per_s, .min = 1, .max = 1e6},
          "counts of the wheel in a second at which the path has its programmed feed; a wheel "
          "that is turned faster does not drive it faster",
          "импульсов маховичка в секунду, при которых контур проходится с "
          "запрограммированной подачей; более быстрое вращение её не повышает"),
      key<&C::healthy>("healthy", {.refers = Refers::digital_input},
                       "input point that is TRUE while the counter means something; FALSE: the wheel is lost",
                       "вход, TRUE, пока счётчик достоверен; FALSE: маховичок потерян"),
  };
  static const Section section{
      "a handwheel that drives programs along their path; chosen by "
      "`NC.path_wheel` of the PLC, a button of the pendant or a client",
      "маховичок, который ведёт программы по контуру; выбирается через "
      "`NC.path_wheel` ПЛК, кнопкой пульта или клиентом",
      keys, &default_object<C>};
  return section;
}

template <>
std::span<const std::string_view> choices_of<PendantWheel>() {
  static constexpr std::string_view kNames[] = {"none", "delta", "counter"};
  return kNames;
}

template <>
const Section& section_of<PendantMap>() {
  using C = PendantMap;
  static constexpr Rule kPlace{.min = -1, .max = 63};
  static const Key keys[] = {
      key<&C::usb_vendor>("usb_vendor", {.min = 1, .max = 65535, .required = true}, "USB number of the maker",
                          "номер изготовителя USB"),
      key<&C::usb_product>("usb_product", {.min = 1, .max = 65535, .required = true},
                           "USB number of the product", "номер изделия USB"),
      key<&C::source>("source", {.required = true}, "where its reports are documented",
                      "где описаны его отчёты"),
      key<&C::tested>("tested", {.required = true}, "what this file was tried on",
                      "на чём проверен этот файл"),
      key<&C::report_number>("report_number", {.min = 0, .max = 255},
                             "first byte of each report; 0: reports have no number",
                             "первый байт каждого отчёта; 0: у отчётов нет номера"),
      key<&C::report_bytes>("report_bytes", {.min = 1, .max = 64, .required = true},
                            "length of a report with its number", "длина отчёта вместе с номером"),
      key<&C::first_key>("first_key", kPlace, "byte with the code of a pressed button; 0 there: none",
                         "байт с кодом нажатой кнопки; 0 в нём: ни одной"),
      key<&C::second_key>("second_key", kPlace, "byte with the code of another pressed button",
                          "байт с кодом второй нажатой кнопки"),
      key<&C::bits>(
          "bits", {.min = -1, .max = 62},
          "first of two bytes with a bit for each button, low byte first; `buttons` numbers bits then",
          "первый из двух байтов с битом на кнопку, младший первым; тогда в `buttons` номера битов"),
      key<&C::axis>("axis", kPlace, "byte of the axis selector", "байт переключателя осей"),
      key<&C::step>("step", kPlace, "byte of the step selector", "байт переключателя шага"),
      key<&C::wheel>("wheel", kPlace, "byte of the wheel", "байт маховичка"),
      key<&C::ring>("ring", kPlace, "byte of a spring-loaded ring, signed",
                    "байт подпружиненного кольца, со знаком"),
      key<&C::wheel_kind>("wheel_kind", {},
                          "delta: signed counts since the last report; counter: a byte that counts round",
                          "delta: импульсы со знаком с прошлого отчёта; counter: байт, считающий по кругу"),
      key<&C::ring_range>("ring_range", {.min = 1, .max = 127}, "largest value of the ring",
                          "наибольшее значение кольца"),
      key<&C::ring_from>("ring_from", {.min = 1, .max = 127}, "from this value on the ring jogs",
                         "с этого значения кольцо двигает ось"),
      key<&C::buttons>("buttons", {}, "code and name of each button: \"0x0C fn\"",
                       "код и имя каждой кнопки: \"0x0C fn\""),
      key<&C::axes>("axes", {},
                    "code and letter of each position of the axis selector: \"0x11 X\", \"0x06 off\"; "
                    "the rows of the display have their order",
                    "код и буква каждого положения переключателя осей: \"0x11 X\", \"0x06 off\"; в этом же "
                    "порядке идут строки дисплея"),
      key<&C::steps>(
          "steps", {},
          "code and length of each step in mm: \"0x0D 0.001\"; without selector the length, and what "
          "the display is told: \"0.001 = 1\"",
          "код и длина каждого шага в мм: \"0x0D 0.001\"; без переключателя — длина и число для "
          "дисплея: \"0.001 = 1\""),
      key<&C::meanings>("meanings", {}, "what a button asks for: \"stop: stop\", \"fn + home: zero\"",
                        "назначение кнопки: \"stop: stop\", \"fn + home: zero\""),
      key<&C::display_number>("display_number", {.min = 0, .max = 255},
                              "number of the feature report that the display takes",
                              "номер отчёта feature, который принимает дисплей"),
      key<&C::display_bytes>("display_bytes", {.min = 0, .max = 63},
                             "bytes of such a report behind its number; 0: no display",
                             "байтов в таком отчёте после номера; 0: дисплея нет"),
      key<&C::display>("display", {},
                       "what stands in the display's bytes: 0x.., work N, machine N, shown N, feed, spindle, "
                       "feed_override, spindle_override, step_mark, flags",
                       "что стоит в байтах дисплея: 0x.., work N, machine N, shown N, feed, spindle, "
                       "feed_override, spindle_override, step_mark, flags"),
  };
  static const Section section{"reports and display of a pendant", "отчёты и дисплей пульта", keys,
                               &default_object<C>};
  return section;
}

}  // namespace servogate::machine
