// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/faults/texts.hpp"

#include <iterator>

namespace servogate::program {
namespace {

constexpr text::Entry kMessages[] = {
    {"P101", "a block has {0} characters, at most {1} are allowed",
     "в кадре {0} символов, допускается не более {1}"},
    {"P102", "the label has no closing quote", "у метки нет закрывающей кавычки"},
    {"P103", "the label \"{0}\" must have 1 to {1} letters or digits",
     "метка «{0}» должна состоять из 1–{1} букв или цифр"},
    {"P104", "{0} stands in the wrong place: a block begins with {1} in this order",
     "{0} стоит не на месте: кадр начинается с {1} в этом порядке"},
    {"P105", "N needs a number without sign and fraction", "после N нужен номер без знака и дробной части"},
    {"P106", "the label {0} stands already in line {1}; jumps go there",
     "метка {0} уже стоит в строке {1}; переходы идут туда"},
    {"P107", "the old control knows comments only as blocks of their own; the text after ; is ignored",
     "старая система знает комментарий только отдельным кадром; текст после ; пропущен"},
    {"P108", "block number {0} has more than {1} digits", "в номере кадра {0} больше {1} цифр"},
    {"P109", "the text has no closing quote", "у текста нет закрывающей кавычки"},
    {"P110", "the block in brackets has no closing bracket", "у кадра в скобках нет закрывающей скобки"},
    {"P112", "the letter {0} is Cyrillic and only looks like the Latin {1}: it is read as {1}",
     "буква {0} русская и только похожа на латинскую {1}: она читается как {1}"},
    {"P113", "this line ends with CR alone; such ends are taken as line ends",
     "строка кончается одним CR; такие концы приняты за концы строк"},
    {"P201", "the character {0} has no meaning here{1}", "символ {0} здесь не имеет смысла{1}"},
    {"P202", "the language has no word {0}{1}", "в языке нет слова {0}{1}"},
    {"P203", "this machine has no axis {0}", "на этом станке нет оси {0}"},
    {"P204", "the word {0} stands twice in the block", "слово {0} стоит в кадре дважды"},
    {"P205", "more than {0} words in the block", "в кадре больше {0} слов"},
    {"P206", "{0}{1} is outside of {2} to {3}", "{0}{1} вне пределов от {2} до {3}"},
    {"P207", "{0} takes a whole number without sign, not {1}",
     "{0} принимает целое число без знака, а не {1}"},
    {"P208", "{0} takes {1}, not {2}", "{0} принимает {1}, а не {2}"},
    {"P209", "{0} needs the number of a parameter", "после {0} нужен номер параметра"},
    {"P210", "the number cannot be read", "число не читается"},
    {"P211", "the language has no G{0}", "в языке нет G{0}"},
    {"P212", "G{0} and G{1} may not stand in one block", "G{0} и G{1} не могут стоять в одном кадре"},
    {"P213", "G{0} stands after {1}: G words come before the operands",
     "G{0} стоит после {1}: слова G идут перед операндами"},
    {"P214", "{0} M words in one block, at most {1} are allowed",
     "слов M в кадре {0}, допускается не более {1}"},
    {"P215", "{0} has no meaning in this block", "слово {0} в этом кадре не имеет смысла"},
    {"P216", "{0} expected here", "здесь ожидается {0}"},
    {"P217", "no parameter can stand for this number", "параметр здесь не может заменить число"},
    {"P218", "{0} needs a number, and {1} has none", "{0} требует числа, а в {1} его нет"},
    {"P219", "{0} takes at most {1} arguments", "{0} принимает не более {1} аргументов"},
    {"P301", "a number, a parameter, a function or a place is expected here",
     "здесь ожидается число, параметр, функция или место памяти"},
    {"P302", "a closing bracket is expected here", "здесь ожидается закрывающая скобка"},
    {"P303", "the language has no function or variable {0}", "в языке нет функции или переменной {0}"},
    {"P304", "{0} takes two values divided by a comma", "{0} принимает два значения через запятую"},
    {"P305", "division by zero", "деление на ноль"},
    {"P306", "{0} of {1} has no value", "{0} от {1} не имеет значения"},
    {"P307", "{0} does not exist, the last parameter is {1}", "{0} не существует, последний параметр {1}"},
    {"P308", "{0} does not fit into {1} ({2}, {3} to {4})", "{0} не помещается в {1} ({2}, от {3} до {4})"},
    {"P309", "{0} holds characters; a number is needed here", "{0} хранит символы; здесь нужно число"},
    {"P310", "= expected after {0}", "после {0} ожидается ="},
    {"P311", "the language has no variable {0}", "в языке нет переменной {0}"},
    {"P312", "the result is too large for a number", "результат слишком велик"},
    {"P313", "{0} has no value yet", "{0} ещё не имеет значения"},
    {"P402", "{0} lies outside of the packet of {1} bytes", "{0} лежит за пределами пакета в {1} байт"},
    {"P403", "{0} does not fit into {1} ({2} to {3})", "{0} не помещается в {1} (от {2} до {3})"},
    {"P404", "the text has {0} characters, {1} takes {2}", "в тексте {0} символов, {1} вмещает {2}"},
    {"P407", "{0} is written by {1}, a program must not write it",
     "{0} пишет {1}, программе писать сюда нельзя"},
    {"P501", "no block has the label {0}", "ни один кадр не имеет метки {0}"},
    {"P502", "repeats are nested deeper than {0}", "вложенность повторов больше {0}"},
    {"P503", "{0} without {1}", "{0} без {1}"},
    {"P504", "{0} without {1}", "{0} без {1}"},
    {"P506", "subprograms are nested deeper than {0}", "вложенность подпрограмм больше {0}"},
    {"P507", "the program {0} is not there", "программы {0} нет"},
    {"P509", "M{0} inside of the subprogram {1}: a subprogram returns at its end",
     "M{0} в подпрограмме {1}: подпрограмма возвращается в своём конце"},
    {"P513", "{0} blocks without a motion or another command: the program does not end",
     "{0} кадров без движения и других команд: программа не кончается"},
    {"P514", "{0} blocks executed, the program does not end", "выполнено {0} кадров, программа не кончается"},
    {"P515", "no line begins with {0}: without it nothing is executed",
     "ни одна строка не начинается с {0}: без него ничего не выполняется"},
    {"P612", "the origin {0} is not in the table, which has {1}",
     "начала отсчёта {0} нет в таблице, в ней есть {1}"},
    {"P613", "the origin {0} has no value for {1}, only for {2}",
     "в начале отсчёта {0} нет значения для {1}, есть только для {2}"},
    {"P614", "the scale must not be 0", "масштаб не может быть 0"},
    {"P617", "the plane of G{0} needs the axes {1} and {2}, this machine lacks {3}",
     "плоскости G{0} нужны оси {1} и {2}, на этом станке нет {3}"},
    {"P625", "{0} = {1} is outside of {2} to {3}", "{0} = {1} вне пределов от {2} до {3}"},
    {"P701", "{0} would go to {1}, the travel ends at {2}", "{0} вышла бы на {1}, ход кончается на {2}"},
    {"P702", "{0} would go to {1}, the working field ends at {2} ({3})",
     "{0} вышла бы на {1}, рабочее поле кончается на {2} ({3})"},
    {"P703", "no feed: F was never programmed", "нет подачи: F ещё не задавалась"},
    {"P704", "G93 needs F in each motion block", "G93 требует F в каждом кадре движения"},
    {"P705", "{0} goes with G94 only", "{0} допустимо только с G94"},
    {"P706", "profile not congruent: the radius is {0} at the start and {1} at the end",
     "профиль не конгруэнтен: радиус в начале {0}, в конце {1}"},
    {"P707", "an arc needs {0} and {1}, or {2}", "дуге нужны {0} и {1} или {2}"},
    {"P708", "an arc needs both {0} and {1}, {2} is missing", "дуге нужны и {0}, и {1}, нет {2}"},
    {"P709", "an arc takes {0} and {1} or {2}, not both",
     "дуга принимает либо {0} и {1}, либо {2}, но не вместе"},
    {"P710", "a full circle cannot be programmed with {0}", "полную окружность нельзя задать через {0}"},
    {"P711", "profile not congruent: {2}{0} is shorter than half the way of {1}",
     "профиль не конгруэнтен: {2}{0} меньше половины хорды {1}"},
    {"P712", "an arc of radius 0", "дуга нулевого радиуса"},
    {"P713", "an arc cannot be scaled differently along {0} and {1}",
     "дугу нельзя масштабировать по {0} и {1} по-разному"},
    {"P714", "{1}{0}: the pitch of a helix must be above 0",
     "{1}{0}: шаг винтовой линии должен быть больше 0"},
    {"P715", "{0} needs a motion of an axis outside of the plane",
     "для {0} нужно движение оси вне плоскости"},
    {"P716", "the helix turns {0} degrees by its depth and pitch, the programmed arc gives {1}",
     "по глубине и шагу винтовая линия поворачивает на {0}°, запрограммированная дуга даёт {1}°"},
    {"P717", "the helix has {0} turns, at most {1} are allowed",
     "винтовая линия имеет {0} витков, допускается не более {1}"},
    {"P718", "{0} goes with an arc only where no rotation, mirror or scale is active",
     "{0} с дугой допустимо только без поворота, зеркала и масштаба"},
    {"P724", "{0}: the step {1} must be above {2}", "{0}: шаг {1} должен быть больше {2}"},
    {"P725", "{0} would take more than {1} steps", "{0} потребовал бы больше {1} шагов"},
    {"P726", "more blocks without a feed: {0}, the last one in line {1}",
     "ещё кадров без подачи: {0}, последний в строке {1}"},
    {"P802", "M{0} and M{1} cannot both end the block", "M{0} и M{1} не могут вместе завершать кадр"},
    {"P803", "M{0} and M{1} contradict each other", "M{0} и M{1} противоречат друг другу"},
    {"P805", "{0}: this machine has no spindle", "{0}: на этом станке нет шпинделя"},
    {"P808", "S{0} is above the {1} rpm of the spindle: it turns at {1}",
     "S{0} больше наибольших {1} об/мин шпинделя: он вращается с {1}"},
    {"P809", "S{0} is below the {1} rpm of the spindle: it turns at {1}",
     "S{0} меньше наименьших {1} об/мин шпинделя: он вращается с {1}"},
    {"P810",
     "{0}: a cutting speed (G96) needs an axis programmed in diameter, this machine has none; program G97, "
     "or "
     "name it in power_on",
     "{0}: скорости резания (G96) нужна ось, программируемая в диаметре, на этом станке её нет; задайте G97 "
     "в программе или в power_on"},
    {"P811", "T{0}: the magazine of this machine has {1} places", "T{0}: в магазине этого станка мест {1}"},
    {"P812", "the corrector {0} is not in the tool table: its lengths count as 0",
     "корректора {0} нет в таблице инструмента: его вылеты считаются нулевыми"},
    {"P813", "{0} asks for {1}/min; in line {2} the axes reach {3}/min ({4}), the motion is as fast as that",
     "{0} требует {1}/мин; в строке {2} оси достигают {3}/мин ({4}), с этой скоростью и идёт движение"},
    {"P814", "further places of {0} are not named", "остальные места с {0} не названы"},
    {"P815",
     "the feed is per revolution (G95), and the program has not started the spindle: the motion waits until "
     "it "
     "turns",
     "подача на оборот (G95), а программа не включила шпиндель: движение ждёт, пока он не завращается"},
    {"P820", "{0} turns the spindle, and no S says how fast: it stands until one does",
     "{0} включает шпиндель, а S не задано: он стоит, пока S не появится"},
    {"P821",
     "{0} turns the spindle by a cutting speed (G96), and the last S was written in rpm: write S in m/min "
     "into the block",
     "{0} включает шпиндель по скорости резания (G96), а последнее S задано в об/мин: запишите в кадре S в "
     "м/мин"},
    {"P817", "{0}: the depth {1} is the level {2} where the work begins: nothing is worked",
     "{0}: глубина {1} совпадает с уровнем {2}, с которого начинается работа: обработки не будет"},
    {"P818",
     "{0}: the depth {1} lies before the level {2} where the work begins: the axis passes it at rapid and "
     "works backwards",
     "{0}: глубина {1} лежит перед уровнем {2}, с которого начинается работа: ось проходит её на быстром "
     "ходу и работает назад"},
    {"P819",
     "{0}: from the bottom at {1} the tool returns to {2}, not back over the level {3} where the work "
     "begins",
     "{0}: со дна на {1} инструмент возвращается на {2}, а не назад за уровень {3}, с которого начинается "
     "работа"},
    {"P901", "{0} is not executed in this version", "{0} в этой версии не выполняется"},
    {"P902", "the power-on mode {0} is not one of this language", "режим включения {0} не из этого языка"},
    {"P903", "there is no dialect {0}", "нет языка {0}"},
    {"P904", "{0} is no mode: it holds for its block only", "{0} не режим: действует только в своём кадре"},
    {"P905", "{0} and {1} exclude one another: of a group one mode is in force",
     "{0} и {1} исключают друг друга: из группы действует один режим"},
    {"P906", "the mode {0} stands twice", "режим {0} назван дважды"},
    {"P907", "from here on {0} more {1} are not named", "отсюда ещё {0} {1} не названо"},
    {"P822",
     "T{0}: the tool is worn out after its life of {1} min, and no alternate is left: replace it and set "
     "used=0 "
     "(`servogate tool set {0} used=0`)",
     "T{0}: инструмент выработал стойкость {1} мин, замены ему нет: смените его и задайте used=0 (`servogate "
     "tool set {0} used=0`)"},
    {"P730", "radius compensation begins with a line, not with an arc: move to the contour with G00 or G01",
     "коррекция на радиус начинается с прямой, а не с дуги: подведите инструмент к контуру G00 или G01"},
    {"P731", "the first motion behind G40 is a line, not an arc: leave the contour with G00 or G01",
     "первое перемещение после G40 — прямая, а не дуга: отойдите от контура G00 или G01"},
    {"P732", "{0} while {1} is active: end the compensation with G40 first",
     "{0} при активной {1}: сначала завершите коррекцию G40"},
    {"P733", "profile not congruent: the tool of radius {0} does not fit into the arc of radius {1}",
     "профиль не конгруэнтен: инструмент радиуса {0} не входит в дугу радиуса {1}"},
    {"P734",
     "profile not congruent: the tool of radius {0} does not fit between the elements before and behind "
     "this one",
     "профиль не конгруэнтен: инструмент радиуса {0} не входит между соседними элементами этого элемента"},
    {"P735", "profile not congruent: the tool of radius {0} does not fit into the corner before this element",
     "профиль не конгруэнтен: инструмент радиуса {0} не входит в угол перед этим элементом"},
    {"P756",
     "profile not congruent: the tool of radius {0} does not fit through the bottleneck: its way crosses "
     "that of "
     "line {1}",
     "профиль не конгруэнтен: инструмент радиуса {0} не проходит через узкое место: его путь пересекает путь "
     "строки {1}"},
    {"P736", "more than {0} blocks without a motion in the plane stand between two elements of a contour",
     "между двумя элементами контура стоит больше {0} кадров без перемещения в плоскости"},
    {"P737", "{0} inside of a compensated contour: end it with G40 first",
     "{0} внутри контура с коррекцией: сначала завершите его G40"},
    {"P738",
     "the block waits for the end of motion inside of a contour whose next element decides where the tool "
     "goes: put it before the contour or behind it",
     "кадр ждёт конца перемещения внутри контура, где путь инструмента зависит от следующего элемента: "
     "поставьте его перед контуром или за ним"},
    {"P739", "r or b stands in a block of its own between two elements of a contour",
     "r или b стоит отдельным кадром между двумя элементами контура"},
    {"P740", "no arc of radius {0} joins the two elements",
     "никакая дуга радиуса {0} не сопрягает эти два элемента"},
    {"P741", "a chamfer stands between two lines", "фаска ставится между двумя прямыми"},
    {"P742", "the chamfer of {0} is longer than the line of {1}", "фаска {0} длиннее прямой {1}"},
    {"P743", "{0} needs the coordinate of {1} in its block", "{0} требует в кадре координаты {1}"},
    {"P744", "the program ends inside of a profile", "программа кончается внутри профиля"},
    {"P745", "the way leads through the protected zone {0}", "путь проходит через защищённую зону {0}"},
    {"P746", "{0}: the tool in force has no radius in the tool table: it cuts along the programmed path",
     "{0}: у действующего инструмента в таблице нет радиуса: он режет по запрограммированному пути"},
    {"P908", "{0} cannot be in force at power-on: a program begins it",
     "{0} не может действовать при включении: её начинает программа"},
    {"P747", "{0} needs a motion at the feed in its block", "{0} требует в кадре перемещения с подачей"},
    {"P748", "{0} waits for the zero mark of a spindle that does not turn: start it first",
     "{0} ждёт нулевой метки шпинделя, который не вращается: сначала включите его"},
    {"P750", "{0} follows other axes now: program those, or end the virtual axes first",
     "ось {0} сейчас следует за другими: программируйте их или сначала отмените виртуальные оси"},
    {"P751", "threads and measurements need the axes of the machine: end the virtual axes first",
     "резьбе и измерению нужны оси станка: сначала отмените виртуальные оси"},
    {"P752", "a feed per revolution is not possible here: a rotary axis or several axes follow the path",
     "подача на оборот здесь невозможна: за траекторией следует поворотная ось или несколько осей"},
    {"P753", "the way comes as near as {0} mm to the centre, the least radius is {1} mm",
     "путь подходит к центру на {0} мм, наименьший радиус — {1} мм"},
    {"P754",
     "{0} is the number of positions in a turn of the axis {1}: a whole number from 1 to {2}, and the "
     "machine needs this rotary axis",
     "{0} — число позиций на оборот оси {1}: целое от 1 до {2}; станку нужна эта поворотная ось"},
    {"P909", "{0} is no code that a language could have: G or M and a number from 0 to {1}",
     "{0} не может быть кодом языка: это G или M и число от 0 до {1}"},
    {"P910", "{0} is a word of the language already: choose another number",
     "{0} уже есть в языке: выберите другой номер"},
    {"P911", "{0}: the word {1} cannot give a parameter: axes, I J K R F and their like can",
     "{0}: слово {1} не может задавать параметр: могут оси, I J K R F и подобные"},
    {"P912", "{0} in the block of {1}: beside it stand only the words that its table names",
     "{0} в кадре с {1}: рядом с ним стоят только слова из его таблицы"},
    {"P755", "{0}: corner {1} does not fit between the parts of the contour beside it",
     "{0}: угол {1} не помещается между соседними участками контура"},
    {"P114", "the skip level {0} is none: there are 0 to 9",
     "уровня пропуска {0} нет: есть уровни от 0 до 9"},
    {"P759", "axis {0} is a spindle now: M{1} makes it an axis first",
     "ось {0} сейчас работает как шпиндель: сначала переведите её в режим оси функцией M{1}"},
    {"P757",
     "the spindle is axis {0} now: it neither turns nor leads a thread, a feed per revolution or another "
     "spindle; M{1} makes it a spindle again first",
     "шпиндель сейчас работает как ось {0}: вращение, резьба, подача на оборот и связь шпинделей невозможны; "
     "сначала верните режим шпинделя функцией M{1}"},
    {"P758", "the second spindle follows this one: end the coupling before it becomes axis {0}",
     "второй шпиндель следует за этим: отмените связь, прежде чем он станет осью {0}"},
    {"P749",
     "threads, rigid taps and starts at the zero mark go by the measured angle of the spindle, and this one "
     "has "
     "no encoder: give its drive one (counts_per_rev in the machine file), or tap with a floating holder",
     "резьба, жёсткое нарезание метчиком и пуск по нулевой метке идут по измеренному углу шпинделя, а у него "
     "нет "
     "датчика: дайте приводу датчик (counts_per_rev в файле станка) или режьте метчиком в плавающем патроне"},
};
static_assert(std::size(kMessages) == static_cast<std::size_t>(Fault::spindle_no_angle) + 1);

}  // namespace

std::span<const text::Entry> messages() { return kMessages; }

std::vector<std::string> outside_arguments(const std::string& letter, bool diameter, double value,
                                           double limit) {
  const double shown = diameter ? 2.0 : 1.0;
  return {diameter ? text::both(letter + " (diameter)", letter + " (диаметр)") : letter,
          text::number(shown * value, 4), text::number(shown * limit, 4)};
}

std::string in_capitals(std::string_view written) {
  std::string out(written);
  for (char& c : out)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return out;
}

std::string capitals_hint(std::string_view written, bool known) {
  const std::string meant = in_capitals(written);
  if (!known || meant == written) return {};
  return text::both(": words are written in capital letters, " + meant,
                    ": слова пишутся прописными буквами, " + meant);
}

const text::Entry& entry(Fault fault) { return kMessages[static_cast<std::size_t>(fault)]; }

}  // namespace servogate::program
