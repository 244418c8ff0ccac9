// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Every sentence the compiler, the engine and the runner can say.
namespace servogate::plc::texts {
using text::Entry;

// Reading the text.
inline constexpr Entry kBadCharacter{"plc-character", "'{0}' does not belong in a program",
                                     "символ '{0}' в программе недопустим"};
inline constexpr Entry kForeignName{
    "plc-character", "'{0}' is no name: names have Latin letters, digits and single underlines",
    "'{0}' не может быть именем: в именах латинские буквы, цифры и одиночные подчёркивания"};
inline constexpr Entry kOpenComment{"plc-open-comment", "this comment never ends; expected '{0}'",
                                    "комментарий не закрыт; ожидается '{0}'"};
inline constexpr Entry kOpenString{"plc-open-string", "this string does not end on its line; expected {0}",
                                   "строка не закрыта до конца строки файла; ожидается {0}"};
inline constexpr Entry kBadEscape{
    "plc-escape", "'{0}' is no escape in a string; $$ writes a dollar sign",
    "'{0}' не является управляющей последовательностью; знак доллара пишется $$"};
inline constexpr Entry kBadWideEscape{
    "plc-escape",
    "'{0}' is no escape in a WSTRING; a number has four digits ($0416), $$ writes a dollar sign",
    "'{0}' не является управляющей последовательностью WSTRING; число пишется четырьмя цифрами ($0416), "
    "знак доллара — $$"};
inline constexpr Entry kBadNumber{"plc-number", "'{0}' is no number", "'{0}' не является числом"};
inline constexpr Entry kHugeNumber{"plc-number-range", "{0} does not fit into 64 bits",
                                   "{0} не помещается в 64 бита"};
inline constexpr Entry kBadTime{"plc-time", "'{0}' is no {1}; write {2}",
                                "'{0}' не является значением {1}; пишите {2}"};
inline constexpr Entry kExpected{"plc-expected", "expected {0}, found {1}", "ожидается {0}, встречено {1}"};
inline constexpr Entry kUnclosed{"plc-unclosed", "expected {0} for the {1} in line {2}, found {3}",
                                 "ожидается {0} для {1} в строке {2}, встречено {3}"};
inline constexpr Entry kAssignEqual{"plc-assign", "'=' compares; write ':=' to assign",
                                    "'=' сравнивает; для присваивания пишите ':='"};
inline constexpr Entry kForeign{"plc-foreign", "'{0}' is not known here; write '{1}'",
                                "'{0}' здесь не применяется; пишите '{1}'"};
inline constexpr Entry kReservedWord{"plc-reserved-word", "'{0}' is a word of the language and no name",
                                     "'{0}' — слово языка и не может быть именем"};
inline constexpr Entry kNoText{"plc-no-text", "this is no text: a byte {0}h stands here",
                               "это не текст: здесь стоит байт {0}h"};
inline constexpr Entry kTooDeep{"plc-depth", "nested deeper than {0} levels",
                                "вложенность больше {0} уровней"};

// Declarations.
inline constexpr Entry kDuplicate{"plc-duplicate", "'{0}' is already declared in {1}",
                                  "'{0}' уже объявлено в {1}"};
inline constexpr Entry kReserved{"plc-reserved", "'{0}' is a standard name and cannot be declared again",
                                 "'{0}' является стандартным именем, повторно объявлять его нельзя"};
inline constexpr Entry kStandardTaken{
    "plc-standard-taken", "'{0}' is a standard type with these values: that one is taken, with its numbers",
    "'{0}' — стандартный тип с этими значениями: взят он, с его номерами"};
inline constexpr Entry kUnknownType{"plc-unknown-type", "there is no type '{0}'{1}", "типа '{0}' нет{1}"};
inline constexpr Entry kTypeCycle{"plc-type-cycle", "'{0}' contains itself", "'{0}' содержит само себя"};
inline constexpr Entry kOpenArrayPlace{"plc-open-array",
                                       "ARRAY[*] is possible as VAR_IN_OUT, and as VAR_INPUT of a FUNCTION",
                                       "ARRAY[*] возможен как VAR_IN_OUT и как VAR_INPUT в FUNCTION"};
inline constexpr Entry kOpenArrayMixed{"plc-open-array", "either all dimensions of an array are * or none",
                                       "звёздочка ставится во всех измерениях массива или ни в одном"};
inline constexpr Entry kOpenArrayWhole{
    "plc-open-array", "{0} is used element by element, or passed on; it cannot be copied whole",
    "{0} используется поэлементно или передаётся дальше; целиком он не копируется"};
inline constexpr Entry kNotConstant{"plc-not-constant", "expected a constant here", "здесь нужна константа"};
inline constexpr Entry kEmptyRange{"plc-empty-range",
                                   "the range {0}..{1} is empty; the lower limit comes first",
                                   "диапазон {0}..{1} пуст; первой пишется нижняя граница"};
inline constexpr Entry kTooLarge{"plc-too-large", "'{0}' needs {1} bytes; at most {2} are possible",
                                 "'{0}' занимает {1} байт; допустимо не более {2}"};
inline constexpr Entry kStringLength{"plc-string-length", "a {1} holds 1 to 255 characters, not {0}",
                                     "длина {1} от 1 до 255 символов, а не {0}"};
inline constexpr Entry kSubrangeBase{"plc-subrange-base", "a subrange needs an integer type, not {0}",
                                     "поддиапазон возможен только для целого типа, а не {0}"};
inline constexpr Entry kNamedBase{
    "plc-subrange-base", "named values need a number, a bit string, a time or a date, not {0}",
    "именованные значения возможны для чисел, битовых строк, времени и дат, а не {0}"};
inline constexpr Entry kNamedValue{"plc-named-value", "'{0}' needs a value; those of {1} are not counted on",
                                   "'{0}' требует значения: у {1} следующего по порядку нет"};
inline constexpr Entry kSectionPlace{"plc-section", "{0} has no place in a {1}", "{0} недопустимо в {1}"};
inline constexpr Entry kNoExternal{"plc-external", "there is no global variable '{0}' for this VAR_EXTERNAL",
                                   "для VAR_EXTERNAL нет глобальной переменной '{0}'"};
inline constexpr Entry kExternalType{"plc-external-type", "'{0}' is {1} where it is declared, not {2}",
                                     "'{0}' объявлена как {1}, а не {2}"};
inline constexpr Entry kEdgeType{"plc-edge", "R_EDGE and F_EDGE belong to a BOOL input",
                                 "R_EDGE и F_EDGE возможны только у входа типа BOOL"};
inline constexpr Entry kBadAddress{"plc-address",
                                   "'{0}' is no address; write %IX0.0, %QW4, %MD2, SA128 or SK10.IN",
                                   "'{0}' не является адресом; пишите %IX0.0, %QW4, %MD2, SA128 или SK10.IN"};
inline constexpr Entry kAddressNumbers{
    "plc-address-numbers",
    "'{0}' has {1} numbers; an address has a byte and a bit, as %IX0.7, or one number, as %IW4",
    "в «{0}» чисел: {1}; в адресе есть байт и бит, как в %IX0.7, или одно число, как в %IW4"};
inline constexpr Entry kAddressRange{"plc-address-range", "{0} lies outside its memory of {1} bytes",
                                     "{0} лежит вне своей памяти ({1} байт)"};
inline constexpr Entry kAddressType{"plc-address-type", "{0} holds {1}, not {2}", "{0} хранит {1}, а не {2}"};
inline constexpr Entry kAddressOverlap{"plc-overlap", "{0} shares memory with {1} of '{2}' in {3}",
                                       "{0} занимает ту же память, что {1} переменной '{2}' в {3}"};
inline constexpr Entry kSymbolOverlap{
    "plc-overlap-symbol", "{0} shares memory with '{1}' of the machine ({2}); use that name",
    "{0} занимает ту же память, что «{1}» станка ({2}); используйте это имя"};
inline constexpr Entry kNoLocation{"plc-no-location",
                                   "no location for {0}; VAR_CONFIG gives it: {1} AT {2}...",
                                   "нет адреса для {0}; его задаёт VAR_CONFIG: {1} AT {2}..."};
inline constexpr Entry kNoLasting{"plc-no-location",
                                  "'{0}' is AT {1}, but its instance does not last; it cannot get a location",
                                  "'{0}' объявлена AT {1}, но её экземпляр временный; адрес задать нельзя"};
inline constexpr Entry kLocationOverlap{"plc-location-overlap", "{0} of '{1}' is taken by '{2}'",
                                        "{0} для '{1}' уже занят '{2}'"};
inline constexpr Entry kUnlocatedGlobal{
    "plc-unlocated", "AT {0} is possible in a PROGRAM or FUNCTION_BLOCK; a global variable needs its address",
    "AT {0} возможно в PROGRAM и FUNCTION_BLOCK; глобальной переменной нужен адрес"};
inline constexpr Entry kNotLocatable{"plc-not-locatable",
                                     "'{0}' is not declared AT %I*, %Q* or %M*; it cannot get a location",
                                     "'{0}' не объявлена AT %I*, %Q* или %M*; адрес задать нельзя"};
inline constexpr Entry kLocationArea{"plc-location-area", "'{0}' is declared AT {1}; {2} lies elsewhere",
                                     "'{0}' объявлена AT {1}; {2} лежит в другой области"};
inline constexpr Entry kLocationType{"plc-location-type", "'{0}' is {1}; AT {2} is for elementary types",
                                     "'{0}' имеет тип {1}; AT {2} возможно для элементарных типов"};
inline constexpr Entry kSharedBit{
    "plc-shared-bit", "the bit of '{0}' is also part of a larger place; this BOOL needs it for itself",
    "бит переменной '{0}' входит и в более длинное место; этой BOOL он нужен отдельно"};
inline constexpr Entry kAddressSection{"plc-address-section",
                                       "only VAR and VAR_GLOBAL can stand AT an address",
                                       "AT возможно только в VAR и VAR_GLOBAL"};
inline constexpr Entry kAddressMember{
    "plc-address-member",
    "a member of a structure stands at a place inside it, such as %B2 or %X3.0, not at {0}",
    "элемент структуры имеет место внутри неё, например %B2 или %X3.0, а не {0}"};
inline constexpr Entry kNoProgram{"plc-no-program", "there is no PROGRAM to run", "нет ни одной PROGRAM"};
inline constexpr Entry kRecursion{"plc-recursion", "'{0}' calls itself ({1}); IEC 61131-3 forbids recursion",
                                  "'{0}' вызывает само себя ({1}); МЭК 61131-3 запрещает рекурсию"};
inline constexpr Entry kNoTask{"plc-no-task", "there is no TASK '{0}' in this resource",
                               "в этом ресурсе нет TASK '{0}'"};
inline constexpr Entry kGlobalTwice{
    "plc-duplicate", "'{0}' is already declared in {1}; one of a resource and one of all cannot share a name",
    "'{0}' уже объявлена в {1}; у переменной ресурса и у общей не может быть одного имени"};
inline constexpr Entry kResourceType{
    "plc-resource-type",
    "'{0}' holds {1}, which uses variables that several resources have; declare it where it is used",
    "'{0}' содержит {1}, а тот использует переменные, которые есть у нескольких ресурсов; объявите его там, "
    "где он нужен"};
inline constexpr Entry kBlockTask{"plc-block-task", "'{0}' runs with TASK '{1}'; {2} cannot call it, too",
                                  "'{0}' выполняется в задаче '{1}'; вызывать его ещё и из {2} нельзя"};
inline constexpr Entry kTaskInterval{"plc-task-interval",
                                     "a task needs a positive INTERVAL or a SINGLE variable",
                                     "задаче нужен положительный INTERVAL или переменная SINGLE"};
inline constexpr Entry kNoResult{"plc-no-result", "the function '{0}' never assigns its result",
                                 "функция '{0}' нигде не присваивает свой результат"};

// Instruction List.
inline constexpr Entry kNoInstruction{"plc-instruction", "'{0}' is no instruction{1}",
                                      "инструкции '{0}' нет{1}"};
inline constexpr Entry kNoCurrent{"plc-no-result-yet",
                                  "'{0}' needs a current result, and there is none here; begin with LD",
                                  "'{0}' требует текущего результата, а здесь его нет; начните с LD"};
inline constexpr Entry kListOnly{
    "plc-list-only",
    "this body is Instruction List because of how it begins; '{0}' belongs to Structured Text",
    "это тело написано на IL (так оно начинается); '{0}' относится к ST"};
inline constexpr Entry kEndOfLine{"plc-end-of-line", "expected the end of the line, found {0}",
                                  "ожидается конец строки, встречено {0}"};
inline constexpr Entry kInParentheses{"plc-in-parentheses", "{0} cannot stand between '(' and ')'",
                                      "{0} недопустимо между '(' и ')'"};
inline constexpr Entry kLabelTwice{"plc-label-twice", "there is already a label '{0}'",
                                   "метка '{0}' уже есть"};
inline constexpr Entry kNoLabel{"plc-no-label", "there is no label '{0}'{1}", "метки '{0}' нет{1}"};

// Ladder.
inline constexpr Entry kNotConnected{"plc-not-connected", "nothing is connected to this input",
                                     "к этому входу ничего не подключено"};
inline constexpr Entry kNoPower{"plc-no-power", "this element gives nothing to its right",
                                "этот элемент ничего не выдаёт вправо"};
inline constexpr Entry kLoop{"plc-loop",
                             "this connection leads back to itself without a function block between",
                             "эта связь ведёт к самой себе без функционального блока между ними"};
inline constexpr Entry kNoConnector{"plc-no-connector", "there is no connector '{0}' for this continuation",
                                    "для этого продолжения нет соединителя '{0}'"};
inline constexpr Entry kLadderCharacter{
    "plc-ladder-character", "'{0}' is no part of a rung; elements stand on a wire: --| a |--( b )--",
    "'{0}' не является частью цепи; элементы стоят на проводе: --| a |--( b )--"};
inline constexpr Entry kLadderOpen{"plc-ladder-open",
                                   "this element is not closed in its line; expected '{0}'",
                                   "элемент не закрыт в своей строке; ожидается '{0}'"};

// PLCopen XML.
inline constexpr Entry kXml{"plc-xml", "this is no XML: {0}", "это не XML: {0}"};
inline constexpr Entry kXmlMissing{"plc-xml-missing", "<{0}> needs '{1}'", "<{0}> требует '{1}'"};
inline constexpr Entry kXmlTwice{"plc-xml-twice", "localId {0} is given twice", "localId {0} задан дважды"};
inline constexpr Entry kXmlNoElement{"plc-xml-element", "there is no element with localId {0}",
                                     "элемента с localId {0} нет"};
inline constexpr Entry kBlockType{"plc-block-type", "this block is drawn as {0}, but '{1}' is {2}",
                                  "этот блок нарисован как {0}, а '{1}' имеет тип {2}"};

// Names and types in statements.
inline constexpr Entry kUnknownName{"plc-unknown-name", "there is no variable '{0}'{1}",
                                    "переменной '{0}' нет{1}"};
inline constexpr Entry kNotAuxiliary{
    "plc-not-auxiliary",
    "'{0}' is an axis of the programs: blocks move those that are `auxiliary` in "
    "the machine file",
    "«{0}» — ось программ: блоки перемещают оси, которые в файле станка "
    "`auxiliary`"};
inline constexpr Entry kUnknownCall{"plc-unknown-call", "there is no function or instance '{0}'{1}",
                                    "функции или экземпляра '{0}' нет{1}"};
inline constexpr Entry kNotCallable{"plc-not-callable", "'{0}' is {1} and cannot be called",
                                    "'{0}' имеет тип {1}, вызвать его нельзя"};
inline constexpr Entry kProgramCall{"plc-program-call",
                                    "'{0}' is a PROGRAM; tasks run it, other code cannot call it",
                                    "'{0}' является PROGRAM: её запускают задачи, вызвать её нельзя"};
inline constexpr Entry kNoMember{"plc-no-member", "{0} has no member '{1}'{2}",
                                 "у {0} нет элемента '{1}'{2}"};
inline constexpr Entry kNotStructured{"plc-not-structured", "'{0}' is {1} and has no members",
                                      "'{0}' имеет тип {1}, элементов у него нет"};
inline constexpr Entry kNotArray{"plc-not-array", "{0} is no array", "{0} не является массивом"};
inline constexpr Entry kDimensions{"plc-dimensions", "this array has {0} dimensions, not {1}",
                                   "размерность массива {0}, а не {1}"};
inline constexpr Entry kIndexType{"plc-index-type", "a subscript is an integer, not {0}",
                                  "индекс должен быть целым, а не {0}"};
inline constexpr Entry kIndexRange{"plc-index-range", "subscript {0} lies outside {1}..{2}",
                                   "индекс {0} вне границ {1}..{2}"};
inline constexpr Entry kBitRange{"plc-bit-range", "{0} has bits 0 to {1}", "у {0} биты от 0 до {1}"};
inline constexpr Entry kMismatch{"plc-type", "expected {0}, found {1}{2}", "ожидается {0}, встречено {1}{2}"};
inline constexpr Entry kMismatchWrite{"plc-type", "expected {0}, found {1}; write {2}",
                                      "ожидается {0}, встречено {1}; пишите {2}"};
inline constexpr Entry kOperands{"plc-operands", "'{0}' does not combine {1} and {2}",
                                 "'{0}' не применимо к {1} и {2}"};
inline constexpr Entry kOperand{"plc-operand", "'{0}' does not apply to {1}", "'{0}' не применимо к {1}"};
inline constexpr Entry kLiteralRange{"plc-literal-range", "{0} does not fit into {1} ({2}..{3})",
                                     "{0} не помещается в {1} ({2}..{3})"};
inline constexpr Entry kNarrowing{"plc-narrowing",
                                  "{0} may not fit into {1}; write {2} to say that it is meant",
                                  "{0} может не поместиться в {1}; если так задумано, пишите {2}"};
inline constexpr Entry kShiftNumber{
    "plc-shift", "{0} is for bit strings; write {1}_TO_{2} to say that the bits of {1} are meant",
    "{0} применяется к битовым строкам; если нужны биты {1}, пишите {1}_TO_{2}"};
inline constexpr Entry kPowerReal{"plc-type", "expected {0}, and ** gives LREAL; write LREAL_TO_{0}",
                                  "ожидается {0}, а ** даёт LREAL; пишите LREAL_TO_{0}"};
inline constexpr Entry kNotVariable{"plc-not-variable", "expected a variable", "ожидается переменная"};
inline constexpr Entry kWriteConstant{"plc-write-constant", "'{0}' is a constant",
                                      "'{0}' является константой"};
inline constexpr Entry kWriteInput{"plc-write-input",
                                   "'{0}' is an input; assigning it here changes only the copy",
                                   "'{0}' является входом; присваивание меняет лишь его копию"};
inline constexpr Entry kWriteOutput{"plc-write-output",
                                    "'{0}' is an output of {1}; only the block itself sets it",
                                    "'{0}' является выходом {1}; его задаёт только сам блок"};
inline constexpr Entry kPrivate{"plc-private", "'{0}' is internal to {1}",
                                "'{0}' является внутренней переменной {1}"};
inline constexpr Entry kWritePlaceNc{"plc-write-nc", "'{0}' is written by the NC; the PLC only reads it",
                                     "'{0}' записывает ЧПУ; ПЛК её только читает"};
inline constexpr Entry kWritePlaceInput{"plc-write-input-point", "'{0}' is an input; the PLC only reads it",
                                        "'{0}' является входом; ПЛК его только читает"};
inline constexpr Entry kWriteFor{"plc-write-for", "'{0}' counts this FOR loop and cannot be assigned in it",
                                 "'{0}' является счётчиком цикла FOR, присваивать ей в нём нельзя"};
inline constexpr Entry kExitOutside{"plc-exit", "{0} stands outside a loop", "{0} вне цикла"};
inline constexpr Entry kForType{"plc-for-type", "FOR counts with an integer variable, not {0}",
                                "счётчиком FOR может быть только целая переменная, а не {0}"};
inline constexpr Entry kForZero{"plc-for-zero", "BY 0 would never end", "с шагом 0 цикл не кончится"};
inline constexpr Entry kCaseType{"plc-case-type", "CASE needs a value of an elementary type, not {0}",
                                 "CASE возможен для значения элементарного типа, а не {0}"};
inline constexpr Entry kCaseTwice{"plc-case-twice", "{0} was already chosen in line {1}",
                                  "значение {0} уже встречалось в строке {1}"};
inline constexpr Entry kNoValue{"plc-no-value", "'{0}' gives no value", "'{0}' не возвращает значения"};
inline constexpr Entry kUseless{"plc-useless",
                                "this statement does nothing; a call or an assignment is expected",
                                "оператор ничего не делает; ожидается вызов или присваивание"};
inline constexpr Entry kEnableNested{
    "plc-enable", "a call with EN or ENO stands alone, as 'x := F(EN := ...);' or 'f(EN := ...);'",
    "вызов с EN или ENO пишется отдельно: 'x := F(EN := ...);' или 'f(EN := ...);'"};
inline constexpr Entry kCount{"plc-arguments", "{0} takes {1} inputs, not {2}", "у {0} входов {1}, а не {2}"};
inline constexpr Entry kNoParameter{"plc-no-parameter", "{0} has no {1} '{2}'{3}",
                                    "у {0} нет параметра ({1}) '{2}'{3}"};
inline constexpr Entry kTwice{"plc-parameter-twice", "'{0}' is given twice", "'{0}' задано дважды"};
inline constexpr Entry kMixed{"plc-mixed-arguments", "name either all inputs or none",
                              "имена указываются либо у всех входов, либо ни у одного"};
inline constexpr Entry kInOutMissing{"plc-in-out", "{0} needs a variable for its VAR_IN_OUT '{1}'",
                                     "{0} требует переменную для VAR_IN_OUT '{1}'"};
inline constexpr Entry kInputMissing{"plc-bound-input", "{0} needs a variable for its VAR_INPUT '{1}'",
                                     "{0} требует переменную для VAR_INPUT '{1}'"};
inline constexpr Entry kInputType{"plc-bound-input", "'{0}' is bound to a variable of exactly {1}, not {2}",
                                  "'{0}' связывается с переменной в точности типа {1}, а не {2}"};
inline constexpr Entry kOpenLimits{"plc-open-limits",
                                   "'{0}' does not take {1}; its limits must fit into DINT",
                                   "'{0}' не принимает {1}; границы должны помещаться в DINT"};
inline constexpr Entry kWriteBoundInput{"plc-write-bound-input",
                                        "'{0}' is an input, and the caller's own; it is only read here",
                                        "'{0}' является входом вызывающего; здесь его можно только читать"};
inline constexpr Entry kInOutType{"plc-in-out-type", "'{0}' is VAR_IN_OUT and needs exactly {1}, not {2}",
                                  "'{0}' (VAR_IN_OUT) требует в точности {1}, а не {2}"};
inline constexpr Entry kOutputType{"plc-output-type",
                                   "'{0}' is VAR_OUTPUT of {1}, which does not fit into {2}",
                                   "'{0}' (VAR_OUTPUT) имеет тип {1}, он не подходит для {2}"};
inline constexpr Entry kBitReference{"plc-bit-reference", "a single bit cannot be passed as VAR_IN_OUT",
                                     "отдельный бит нельзя передать как VAR_IN_OUT"};
inline constexpr Entry kInstanceCopy{
    "plc-instance", "{0} is a function block; its instance is called, not assigned",
    "{0} является функциональным блоком: экземпляр вызывают, а не присваивают"};
inline constexpr Entry kInstancesCopy{
    "plc-instances", "{0} holds instances of a function block; they are called one by one, not assigned",
    "{0} содержит экземпляры функционального блока: их вызывают по одному, а не присваивают"};
inline constexpr Entry kNoReference{"plc-no-reference", "'^' needs a reference, not {0}",
                                    "'^' применимо к ссылке, а не к {0}"};
inline constexpr Entry kReferenceLasts{
    "plc-reference",
    "'{0}' does not last ({1}); REF takes variables of programs, function blocks, VAR_GLOBAL",
    "'{0}' временная ({1}); REF возможно для переменных программ, функциональных блоков и VAR_GLOBAL"};
inline constexpr Entry kReferenceBit{"plc-reference", "there is no reference to a single bit",
                                     "ссылка на отдельный бит невозможна"};
inline constexpr Entry kReferenceInstance{
    "plc-reference", "'{0}' does not last ({1}), and {2} takes references to its own variables",
    "'{0}' временная ({1}), а {2} берёт ссылки на свои переменные"};
inline constexpr Entry kReferenceRetain{"plc-reference-retain",
                                        "'{0}' holds a reference and cannot be retained",
                                        "'{0}' содержит ссылку, сохранять её значение нельзя"};
inline constexpr Entry kReferenceNever{"plc-reference-never",
                                       "{1} is never {0}: this attempt always gives NULL",
                                       "{1} никогда не {0}: результат попытки всегда NULL"};
inline constexpr Entry kNotEnumValue{"plc-enum-value", "{0} has no value '{1}'{2}",
                                     "у {0} нет значения '{1}'{2}"};
inline constexpr Entry kConstantFault{"plc-constant", "this constant cannot be computed: {0}",
                                      "константу нельзя вычислить: {0}"};
inline constexpr Entry kListLength{"plc-list-length", "{0} values for {1} elements",
                                   "значений {0}, элементов {1}"};
inline constexpr Entry kUnsupported{"plc-unsupported", "{0} is not supported", "{0} не поддерживается"};

// Warnings.
inline constexpr Entry kUnused{"plc-unused", "'{0}' is never used", "'{0}' нигде не используется"};
inline constexpr Entry kTwoWriters{"plc-two-writers", "'{0}' is written in {1} and in {2}",
                                   "'{0}' записывается и в {1}, и в {2}"};
inline constexpr Entry kTwoWritersOverlap{
    "plc-two-writers", "'{0}' is written in {1}, and '{2}', which shares memory with it, in {3}",
    "'{0}' записывается в {1}, а '{2}', занимающая ту же память, — в {3}"};
inline constexpr Entry kTaskShort{
    "plc-task-short", "INTERVAL {0} is shorter than the machine's cycle of {1}; the task runs once a cycle",
    "INTERVAL {0} короче такта станка {1}; задача выполняется один раз за такт"};
inline constexpr Entry kFastTask{"plc-task-range", "priority {0}; 0 to 65535 is possible",
                                 "приоритет {0}; возможны значения от 0 до 65535"};

inline constexpr Entry kBitsCopied{
    "plc-bits-copied",
    "this copies the bits of the {0} (1.0 is 16#{1}) and converts no number; for that, convert to {2} first",
    "здесь копируются биты {0} (1.0 станет 16#{1}), число не преобразуется; для числа преобразуйте сначала в "
    "{2}"};
inline constexpr Entry kNumberToBits{"plc-number-to-bits",
                                     "this converts the number; the bits of a {0} are those of a {1}",
                                     "здесь преобразуется число; биты {0} лежат в {1}"};
inline constexpr Entry kNoValueGiven{"plc-constant-value",
                                     "the constant '{0}' has no value: it is what its type begins with",
                                     "у константы «{0}» нет значения: она равна начальному значению типа"};
inline constexpr Entry kAccessInProgram{
    "plc-access-program",
    "VAR_ACCESS of a PROGRAM is not carried out: from outside a variable has its own name, Program.variable",
    "VAR_ACCESS в PROGRAM не действует: снаружи переменная доступна под своим именем, Программа.переменная"};
inline constexpr Entry kUtf16{"plc-utf16", "the file is UTF-16: save it as UTF-8",
                              "файл в UTF-16: сохраните его в UTF-8"};

// The compilation itself.
inline constexpr Entry kMoreErrors{"plc-more-errors", "{0} more errors: the first {1} are shown",
                                   "ещё ошибок: {0}; показаны первые {1}"};
inline constexpr Entry kMoreWarnings{"plc-more-warnings", "{0} more warnings: the first {1} are shown",
                                     "ещё предупреждений: {0}; показаны первые {1}"};
inline constexpr Entry kCancelled{
    "plc-compile-cancelled", "compiling was ended before it was done: it took longer than is allowed here",
    "трансляция прервана: она длилась дольше, чем здесь допустимо"};
inline constexpr Entry kCodeSize{"plc-code-size",
                                 "the program has more than {0} instructions, and this is where they end",
                                 "в программе больше {0} команд, предел достигнут здесь"};

// Running.
inline constexpr Entry kFaultBudget{"plc-fault-budget", "task {0} exceeded its {1} instructions a scan here",
                                    "задача {0} превысила здесь {1} команд за цикл"};
inline constexpr Entry kDividesByZero{"plc-division", "this divides by zero whenever it is computed",
                                      "при каждом вычислении здесь деление на нуль"};
inline constexpr Entry kFaultDivision{"plc-fault-division", "task {0} divided by zero",
                                      "задача {0}: деление на нуль"};
inline constexpr Entry kFaultIndex{"plc-fault-index", "task {0}: subscript outside its array",
                                   "задача {0}: индекс вне границ массива"};
inline constexpr Entry kFaultSubrange{"plc-fault-subrange", "task {0}: value outside its subrange",
                                      "задача {0}: значение вне поддиапазона"};
inline constexpr Entry kFaultConversion{"plc-fault-conversion", "task {0}: the value cannot be converted",
                                        "задача {0}: значение не преобразуется"};
inline constexpr Entry kFaultSelector{"plc-fault-selector", "task {0}: the selector of MUX names no input",
                                      "задача {0}: селектор MUX не указывает ни на один вход"};
inline constexpr Entry kFaultText{"plc-fault-text", "task {0}: position outside the string",
                                  "задача {0}: позиция вне строки"};
inline constexpr Entry kFaultReference{"plc-fault-reference",
                                       "task {0}: a reference that is NULL was followed",
                                       "задача {0}: обращение по ссылке, равной NULL"};
inline constexpr Entry kFaultOverrun{"plc-fault-overrun",
                                     "task {0}: the scan did not come back and was ended here",
                                     "задача {0}: скан не завершился вовремя и прерван здесь"};
inline constexpr Entry kFaultPackets{"plc-fault-packets", "packet K or SYVAR is smaller than compiled for",
                                     "пакет K или SYVAR меньше, чем при трансляции"};
inline constexpr Entry kRunCycleNumber{"plc-run-cycle", "'{0}' behind '@' is no number of a cycle",
                                       "'{0}' после '@' не является номером цикла"};
inline constexpr Entry kRunName{"plc-run-name", "there is no variable '{0}'", "переменной '{0}' нет"};
inline constexpr Entry kRunValue{"plc-run-value", "'{0}' is no value for '{1}' of type {2}",
                                 "'{0}' не является значением для '{1}' типа {2}"};
inline constexpr Entry kRunCycle{"plc-run-cycle", "cycle {0} is outside 1..{1}",
                                 "цикл {0} вне диапазона 1..{1}"};

}  // namespace servogate::plc::texts
