// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway::says {

using text::Entry;

const Entry kBadLine{"socket.bad-line", "this is no JSON: {0}", "это не JSON: {0}"};
const Entry kNoObject{"socket.no-object", "a request is an object as {\"cmd\":\"status\"}, and this is {0}",
                      "запрос — это объект вида {\"cmd\":\"status\"}, а здесь {0}"};
const Entry kNested{"socket.nested", "a request is nested at most {0} deep",
                    "вложенность запроса не может быть больше {0}"};
const Entry kRepeated{"socket.repeated", "'{0}' stands twice in the request", "«{0}» стоит в запросе дважды"};
const Entry kWrongType{"socket.wrong-type", "'{0}' must be {1}, and is {2}",
                       "«{0}»: ожидается {1}, а здесь {2}"};
const Entry kLongLine{"socket.long-line", "a request is at most {0} bytes long",
                      "запрос не может быть длиннее {0} байт"};
const Entry kFull{"socket.full", "{0} clients are connected already", "уже подключено клиентов: {0}"};
const Entry kUnknown{"socket.unknown-command", "no such command: '{0}'", "нет такой команды: «{0}»"};
const Entry kUnknownAsker{"socket.unknown-asker", "'{0}' may not ask here; askers are {1}",
                          "«{0}» не может спрашивать здесь; возможны {1}"};
const Entry kNoAxis{"socket.no-axis", "the machine has no axis '{0}'; it has {1}",
                    "у станка нет оси «{0}»; есть {1}"};
const Entry kNotUnit{"socket.not-unit", "'{0}' is not the unit of {1}: it moves in {2}",
                     "«{0}» — не единица оси {1}: её единица — {2}"};
const Entry kNoNumber{"socket.no-number", "'{0}' must be a number", "«{0}» должно быть числом"};
const Entry kNotProcess{"socket.not-process", "'process' must be a whole number from 1 to {0}",
                        "«process» должно быть целым числом от 1 до {0}"};
const Entry kNotTable{"socket.not-table", "'table' must be 'origin' or 'tool', and is '{0}'",
                      "«table» должно быть 'origin' или 'tool', а здесь «{0}»"};
const Entry kRowRange{"tables.row-range", "a number of {0} is a whole one from {1} to {2}",
                      "номер {0} — целое число от {1} до {2}"};
const Entry kRowMissing{"tables.row-missing", "{0} {1} is not in the table; it has {2}",
                        "{0} {1} нет в таблице; в ней {2}"};
const Entry kEntryUnknown{"tables.entry-unknown", "'{0}' is no value of {1}; possible are {2}",
                          "«{0}» — не величина {1}; возможны {2}"};
const Entry kEntryRange{"tables.entry-range", "{0} = {1} is outside {2} to {3}", "{0} = {1} вне {2} ... {3}"};
const Entry kEntryHere{"tables.entry-here", "'{0}' has no place that could be touched; give axis letters",
                       "«{0}» нельзя снять касанием; задайте буквы осей"};
const Entry kNothingGiven{"tables.nothing-given", "no value was given, as X100 or length=85",
                          "значения не заданы; например, X100 или length=85"};
const Entry kNoUndo{"tables.no-undo", "there is no change to undo", "отменять нечего"};
const Entry kNotImported{"tables.not-imported", "{0} was not imported, and nothing was changed",
                         "файл {0} не загружен, ничего не изменено"};
const Entry kNotSwitch{"socket.not-switch", "'{0}' must be 1 or 0", "«{0}» должно быть 1 или 0"};
const Entry kNoAnswer{"socket.no-answer", "the cycle did not answer; is it running?",
                      "цикл не ответил; работает ли он?"};
const Entry kLeftToCycle{"socket.left-to-cycle",
                         "the cycle did not answer; it carries the request out when it goes on",
                         "цикл не ответил; он выполнит запрос, когда продолжится"};
const Entry kWithdrawn{"socket.withdrawn",
                       "the cycle did not answer; the request was withdrawn and nothing was done",
                       "цикл не ответил; запрос отозван, ничего не сделано"};
const Entry kOvertaken{
    "socket.overtaken",
    "a stop came after this request, so nothing moves; repeat the request if the motion is still wanted",
    "после этого запроса пришёл останов, поэтому движения нет; если оно ещё нужно, повторите запрос"};
const Entry kEnding{
    "socket.ending",
    "the control is shutting down: axes and spindles are coming to rest (`servogate status` shows them)",
    "управление завершается: оси и шпиндели останавливаются, их показывает `servogate status`"};
const Entry kComesOn{
    "socket.comes-on",
    "the drives are just being switched on: try again in a moment (`servogate status` shows them)",
    "приводы как раз включаются: повторите через мгновение, их показывает `servogate status`"};
const Entry kNotReadable{"socket.not-readable", "{0} cannot be read: {1}", "{0} не читается: {1}"};
const Entry kNotLoaded{"socket.not-loaded", "{0} was not loaded", "программа {0} не загружена"};
const Entry kNotStarted{"socket.not-started",
                        "{0} is not started: with the present origins and tools it has errors",
                        "программа {0} не пущена: с нынешними началами и инструментом в ней ошибки"};
const Entry kMoreFindings{"socket.more-findings", "and {0} more; `servogate check` shows all of them",
                          "и ещё {0}; все показывает `servogate check`"};
const Entry kBlockWrong{"socket.block-wrong", "the block was not run: {0}", "кадр не выполнен: {0}"};
const Entry kBlocksSeveral{"socket.blocks-several", "one block at a time: there is more than one line",
                           "по одному кадру: здесь больше одной строки"};
const Entry kNoDistance{"socket.no-distance", "{0}: the distance is 0", "{0}: расстояние равно 0"};
const Entry kBlockEmpty{"socket.block-empty", "the block is empty", "кадр пуст"};
const Entry kNoJog{"socket.no-jog", "nothing jogs for this client", "для этого клиента ничего не движется"};
const Entry kNoSuchObject{"socket.no-such-object",
                          "sdo_read needs bus, node, index and subindex of a node of the machine file",
                          "sdo_read требует bus, node, index и subindex узла из файла станка"};
const Entry kForeignNode{
    "socket.foreign-node",
    "node {0} is not in the machine file of the control that holds the bus; its nodes are {1}",
    "узла {0} нет в файле станка управления, которое держит шину; её узлы: {1}"};
const Entry kOnlyRead{
    "socket.only-read",
    "a `servogate run` does not take '{0}': its socket only says which buses it uses, and reads objects",
    "`servogate run` не принимает «{0}»: его сокет лишь говорит, какие шины он держит, и читает объекты"};
const Entry kObjectUnanswered{
    "socket.object-unanswered",
    "the node is not running under this control, or another client is reading from it",
    "узел сейчас не работает под этим управлением, либо в эту минуту читает кто-то другой"};
const Entry kNotSaved{"socket.not-saved", "done, but the state was not saved: {0}",
                      "выполнено, но состояние не сохранено: {0}"};

const Entry kPowerOn{"said.power-on", "the drives are being switched on", "приводы включаются"};
const Entry kPowerOff{"said.power-off", "the drives are being switched off", "приводы выключаются"};
const Entry kHomingAll{"said.homing-all", "homing all axes in the machine's order",
                       "выход в ноль всех осей в порядке станка"};
const Entry kHoming{"said.homing", "homing {0}", "выход в ноль: {0}"};
const Entry kJog{"said.jog", "{0} moves by {1} {2}", "{0} перемещается на {1} {2}"};
const Entry kJogDiameter{"said.jog-diameter", "{0} moves by {1} mm in diameter (the slide by {2} mm)",
                         "{0} перемещается на {1} мм по диаметру (суппорт на {2} мм)"};
const Entry kJogClipped{"said.jog-clipped", "{0} moves to its travel limit only, {1} {2}",
                        "{0} перемещается только до границы зоны, {1} {2}"};
const Entry kJogs{"said.jogs", "{0} jogs {1} for as long as this client keeps asking",
                  "{0} движется в направлении {1}, пока клиент это подтверждает"};
const Entry kZero{"said.zero", "{0} is {1} {2} here (origin {3} at {4})",
                  "{0} здесь равна {1} {2} (начало {3} в {4})"};
const Entry kZeroDiameter{"said.zero-diameter", "{0} is {1} {2} in diameter here (origin {3} at radius {4})",
                          "{0} здесь равна {1} {2} по диаметру (начало {3} на радиусе {4})"};
const Entry kBlockRuns{"said.block-runs", "the block runs{0}", "кадр выполняется{0}"};
const Entry kRowSet{"said.row-set", "{0} {1}: {2}", "{0} {1}: {2}"};
const Entry kRowCleared{"said.row-cleared", "{0} {1} is no longer in the table",
                        "{0} {1} больше нет в таблице"};
const Entry kTablesUndone{"said.tables-undone", "the last change of origins and tools is undone",
                          "последнее изменение начал и инструмента отменено"};
const Entry kImported{"said.imported", "{0}: {1} rows are in the table now",
                      "{0}: строк в таблице теперь {1}"};
const Entry kAssigned{"said.assigned", "the programs of process {1} move {0} from now on",
                      "{0} теперь перемещают программы процесса {1}"};
const Entry kLoaded{"said.loaded", "{0} is loaded: {1} blocks, {2} warnings",
                    "{0} загружена: кадров {1}, предупреждений {2}"};
const Entry kStarted{"said.started", "{0} runs", "{0} выполняется"};
const Entry kTypedGoesOn{"said.typed-goes-on", "the typed block goes on: {0}",
                         "введённый кадр продолжается: {0}"};
const Entry kStepped{"said.stepped", "one block runs", "выполняется один кадр"};
const Entry kHeld{"said.held", "feed hold: the axes stop on the path",
                  "пауза подачи: оси останавливаются на контуре"};
const Entry kManualStopped{"said.manual-stopped", "jogging and homing stop; nothing resumes them",
                           "ручной ход и выход в ноль останавливаются; продолжить их нельзя"};
const Entry kNothingHeld{"said.nothing-held", "no program runs: there is nothing to hold",
                         "программа не выполняется: приостанавливать нечего"};
const Entry kResumed{"said.resumed", "the program goes on", "программа продолжается"};
const Entry kStopped{"said.stopped", "everything stops", "всё останавливается"};
const Entry kJogStopped{"said.jog-stopped", "the jog of this axis stops",
                        "ручной ход этой оси останавливается"};
const Entry kJogsStopped{"said.jogs-stopped", "all jogs stop", "ручной ход всех осей останавливается"};
const Entry kNotJogged{"said.not-jogged", "this axis is not being jogged: there is nothing to stop",
                       "эту ось не перемещают вручную: останавливать нечего"};
const Entry kNothingJogged{"said.nothing-jogged", "no axis is being jogged: there is nothing to stop",
                           "ни одну ось не перемещают вручную: останавливать нечего"};
const Entry kPlaceSet{"said.place-set", "{0} = {1}", "{0} = {1}"};
const Entry kNoPlace{"socket.no-place", "'{0}' is no place of packet K", "«{0}» — не адрес пакета K"};
const Entry kReset{"said.reset", "reset; no alarm is active", "сброс; активных аварий нет"};
const Entry kResetLeft{"said.reset-left", "reset, but still active: {0}", "сброс, но ещё активны: {0}"};
const Entry kOverride{"said.override", "feed override {0} %", "коррекция подачи {0} %"};
const Entry kObjectRead{"said.object-read", "the node has answered", "узел ответил"};
const Entry kDown{"said.down", "the control stops the axes, switches the drives off and ends",
                  "управление останавливает оси, выключает приводы и завершает работу"};

const Entry kPathTooLong{"socket.path-too-long", "the path is longer than a socket's name may be",
                         "путь длиннее, чем допускает имя сокета"};
const Entry kAnotherListens{
    "socket.another-listens",
    "another control listens there; end it with `servogate down`, or choose --socket",
    "там уже работает другое управление; завершите его (`servogate down`) или укажите --socket"};
const Entry kNoSocketFile{"socket.not-a-socket", "there is a file of that name that is no socket",
                          "файл с таким именем есть, и это не сокет"};
const Entry kNoFolder{"socket.no-folder",
                      "folder {0} does not exist; make it first, or choose another --socket",
                      "каталога {0} нет; сначала создайте его или укажите другой --socket"};
const Entry kForeignFolder{"socket.foreign-folder", "folder {0} belongs to somebody else",
                           "каталог {0} принадлежит другому пользователю"};

}  // namespace servogate::gateway::says
