// SPDX-License-Identifier: Apache-2.0
// Texts of the page in both languages; data-t attributes and tr() refer to the keys.
const TEXTS = {
  finished: ["Finished", "Выполнено"],
  unfinished: ["Not finished", "Не завершено"],
  errorsFound: ["What was found in the program", "Что найдено в программе"],
  alarms: ["Alarms", "Аварии"],
  forced: ["Forced from outside during the whole run", "Удерживалось извне в течение всего прогона"],
  touches: ["Touches of the probe", "Касания щупа"],
  "touch.place": ["Mean place, machine coordinates", "Среднее положение, координаты станка"],
  "touch.count": ["Touches", "Касаний"],
  "touch.spread": ["Spread", "Размах"],
  "touch.deviation": ["Standard deviation", "Среднее квадр. отклонение"],
  "touch.each": ["Each touch, off the mean", "Каждое касание относительно среднего"],
  noAlarms: ["No alarms.", "Аварий нет."],
  time: ["Machine time", "Машинное время"],
  blocks: ["Blocks", "Кадры"],
  ofAbout: ["of about {0}", "примерно из {0}"],
  cyclesOf: ["{0} cycles of {1}", "циклов: {0} по {1}"],
  extents: ["Extents", "Габариты"],
  timing: ["Timing and buses", "Время цикла и шины"],
  cycle: ["Cycle", "Цикл"],
  lateness: ["Wake-up lateness", "Опоздание пробуждения"],
  segment: ["Bus segment", "Сегмент шины"],
  syncLate: ["Lateness of SYNC on", "Запаздывание SYNC на"],
  syncSkew: ["Between the first and the last SYNC of a cycle", "Между первым и последним SYNC такта"],
  load: ["Load", "Загрузка"],
  sent: ["Sent", "Передано"],
  received: ["Received", "Принято"],
  errors: ["Errors", "Ошибки"],
  virtual: ["virtual time", "виртуальное время"],
  speed: ["Virtual speed", "Виртуальная скорость"],
  timesReal: ["× real time", "× реального времени"],
  cycleTime: ["Cycle time p99", "Время цикла p99"],
  late: ["Wake-up lateness p99", "Опоздание пробуждения p99"],
  overruns: ["Overruns", "Превышения цикла"],
  starved: ["Planning starved", "Нехватка планирования"],
  busLoad: ["Bus load", "Загрузка шины"],
  worst: ["worst cycle", "худший цикл"],
  max: ["max", "макс."],
  pathLength: ["Path", "Путь"],
  feedPath: ["feed", "подача"],
  rapidPath: ["rapid", "быстрый ход"],
  homingPath: ["homing, by hand", "выход в ноль, вручную"],
  still: ["standing", "стоянка"],
  moving: ["Where the time went", "На что ушло время"],
  limits: ["Axes against their limits", "Оси относительно пределов"],
  velocity: ["Velocity", "Скорость"],
  acceleration: ["Acceleration", "Ускорение"],
  jerk: ["Jerk", "Рывок"],
  error: ["Following error", "Ошибка слежения"],
  noLimit: ["no limit given", "предел не задан"],
  workPlace: ["in the program's coordinates; small: in the machine's", "в координатах программы; мелко — в координатах станка"],
  machinePlace: ["in the machine's coordinates", "в координатах станка"],
  path: ["Path", "Траектория"],
  plan: ["Plan", "План"],
  front: ["Front", "Спереди"],
  side: ["Side", "Сбоку"],
  iso: ["Isometric", "Изометрия"],
  allOperations: ["all operations", "все переходы"],
  "colour.speed": ["colour: speed", "цвет: скорость"],
  "colour.deviation": ["colour: deviation", "цвет: отклонение"],
  "colour.tool": ["colour: tool", "цвет: инструмент"],
  "colour.bound": ["colour: what limits the speed", "цвет: что ограничивает скорость"],
  bound: ["limited by", "ограничивает"],
  "bound.feed": ["the feed", "подача"],
  "bound.velocity": ["velocity", "скорость оси"],
  "bound.acceleration": ["acceleration", "ускорение"],
  "bound.jerk": ["jerk", "рывок"],
  "bound.tolerance": ["corners in the tolerance", "углы в пределах допуска"],
  "bound.rest": ["a rest", "останов"],
  deviation: ["off the path by", "отклонение от траектории"],
  turned: ["{0} is a diameter; the turned contour is drawn around the machine's {0} = 0.", "{0} — диаметр; контур показан вокруг {0} = 0 станка."],
  ofRadius: ["(of the radius)", "(по радиусу)"],
  noWebgl: ["This browser offers no WebGL, so the path is not drawn; everything else is here.", "В этом браузере нет WebGL: траектория не показана, всё остальное на месте."],
  broken: ["The page cannot show its data ({0}). It needs a browser of 2023 or later.", "Страница не может показать данные ({0}). Нужен браузер 2023 года или новее."],
  rapids: ["Rapids and homing", "Быстрый ход и выход в ноль"],
  wholePath: ["Everything in view", "Показать всё"],
  travel: ["travel of the machine", "ход станка"],
  hint3: ["Drag to turn · right button or Shift + drag to move · Ctrl + wheel to zoom (plain wheel after a click) · double click to fit · click on a line of the program to see where it cuts",
    "Тянуть — поворот · правая кнопка или Shift + тянуть — сдвиг · Ctrl + колесо — масштаб (после щелчка — просто колесо) · двойной щелчок — вписать · щелчок по строке программы — где она режет"],
  hint3Finger: ["One finger turns · two fingers move and zoom · tap a line of the program to see where it cuts",
    "Один палец — поворот · два пальца — сдвиг и масштаб · касание строки программы — где она режет"],
  hintTimeFinger: ["One finger moves along the time · two fingers zoom · the button “All” shows the whole run",
    "Один палец — сдвиг по времени · два пальца — масштаб · кнопка «Всё» — весь прогон"],
  everyCycle: ["Every cycle is drawn ({0}).", "Показан каждый такт ({0})."],
  band: ["A band spans the least and the greatest value of each {0}; zoom in to see every cycle.", "Полоса — от наименьшего до наибольшего значения за каждые {0}; увеличьте, чтобы видеть каждый такт."],
  notKept: ["Single cycles of this stretch were not kept: the run was too long.", "Отдельные такты этого участка не сохранены: прогон слишком длинный."],
  everyKept: ["Every cycle of the run is in this page.", "В странице есть каждый такт прогона."],
  everyPart: ["Of the run's cycles {0} are in this page, around alarms and at its end.", "В странице есть такты за {0}: около аварий и в конце прогона."],
  compare: ["Lay another run over this one", "Наложить другой прогон"],
  compareWith: ["Compared", "Сравнение"],
  compareOff: ["Take it away", "Убрать"],
  noPage: ["That file is no report page of this version.", "Этот файл — не страница отчёта этой версии."],
  thisRun: ["this run", "этот прогон"],
  otherRun: ["the other run", "другой прогон"],
  difference: ["difference", "разность"],
  notices: ["Software of others in this page", "Чужие программы в этой странице"],
  "phase.receive": ["receive", "приём"],
  "phase.logic": ["logic (PLC)", "логика (ПЛК)"],
  "phase.interpolate": ["interpolate", "интерполяция"],
  "phase.axes": ["axes", "оси"],
  "phase.send": ["send", "передача"],
  "phase.publish": ["publish", "публикация"],
  motion: ["Motion over time", "Движение во времени"],
  hintTime: ["Drag to zoom into a stretch · Shift + drag to move · Ctrl + wheel to zoom · double click for all",
    "Тянуть — увеличить участок · Shift + тянуть — сдвиг · Ctrl + колесо — масштаб · двойной щелчок — всё"],
  all: ["All", "Всё"],
  pathSpeed: ["Path speed", "Скорость по пути"],
  spindle: ["Spindle", "Шпиндель"],
  threadOff: ["Thread: off the spindle's angle", "Резьба: отклонение от угла шпинделя"],
  signals: ["Signals", "Сигналы"],
  noSignals: ["No signals were chosen for this run.", "Для этого прогона сигналы не выбраны."],
  constant: ["Show signals that never change", "Показать неизменные сигналы"],
  steady: ["never changed", "не менялись"],
  on: ["on", "вкл"],
  off: ["off", "выкл"],
  line: ["Line", "Строка"],
  program: ["Program", "Программа"],
  follow: ["Follow the cursor", "Следовать за курсором"],
  provenance: ["Where this report comes from", "Происхождение отчёта"],
  number: ["No.", "№"],
  at: ["At", "Время"],
  what: ["What happened", "Что произошло"],
  where: ["Where", "Где"],
  reaction: ["Reaction", "Реакция"],
  consequence: ["consequence of", "следствие"],
  version: ["Version", "Версия"],
  commit: ["Commit", "Ревизия"],
  machine: ["Machine file", "Файл станка"],
  programFile: ["Program", "Программа"],
  plc: ["PLC", "ПЛК"],
  dialect: ["Dialect", "Диалект"],
  seed: ["Seed", "Начальное число"],
  clock: ["Clock", "Часы"],
  buses: ["Buses", "Шины"],
  kernel: ["Kernel", "Ядро ОС"],
  processor: ["Processor", "Процессор"],
  nodes: ["Nodes", "Узлы"],
  command: ["Command line", "Командная строка"],
  resolution: ["Resolution", "Разрешение"],
  resolutionText: ["series {0} per bucket (least and greatest kept), path within {1}",
    "графики {0} на отрезок (с минимумом и максимумом), путь в пределах {1}"],
  dropped: ["{0} cycles were lost by the recorder; the plots have gaps.", "Регистратор потерял циклов: {0}; на графиках есть пропуски."],
  play: ["Play", "Пуск"],
  pause: ["Pause", "Пауза"],
  theme: ["Theme", "Тема"],
  none: ["none", "нет"],
  warn: ["warning", "предупреждение"],
  stop_at_block_end: ["stop at block end", "останов в конце кадра"],
  stop_on_path: ["stop on the path", "останов на траектории"],
  stop_axes: ["stop of the axes", "останов осей"],
  stop_and_power_off: ["stop of the axes, then power off", "останов осей, затем отключение питания"],
  quick_stop: ["quick stop", "быстрый останов"],
  power_off: ["power off", "отключение питания"],
  axis: ["axis", "ось"],
  node: ["node", "узел"],
  block: ["block", "кадр"],
};
const UNITS_RU = {"mm": "мм", "mm/s": "мм/с", "mm/min": "мм/мин", "mm/s²": "мм/с²", "mm/s³": "мм/с³", "deg": "°", "deg/s": "°/с",
  "deg/s²": "°/с²", "deg/s³": "°/с³", "µm": "мкм", "rpm": "об/мин", "s": "с", "ms": "мс", "µs": "мкс", "m": "м", "arcsec": "″"};
const UNITS_EN = {"deg": "°", "deg/s": "°/s", "deg/s²": "°/s²", "deg/s³": "°/s³", "arcsec": "″"};

/** The text of a key, its values put in. A key that is none stands for itself, or for its first value after a dot. */
function tr(key, ...values) {
  const entry = TEXTS[key] || (key.includes(".") && values.length ? [values[0], values[0]] : null);
  const text = entry ? entry[S.lang === "ru" ? 1 : 0] : key;
  return text.replace(/\{(\d)\}/g, (_, n) => values[+n]);
}
/** A sentence as the page shows it: its first letter large, decimal signs of the language. */
function sentence(text) {
  const words = S.lang === "ru" ? text.replace(/(^|[\s(])([+\-−]?\d+)\.(\d+)(?=[\s,;:)%]|$)/g, "$1$2,$3") : text;
  return words.charAt(0).toUpperCase() + words.slice(1);
}
/** What the reader holds: a finger or a mouse. */
function byFinger() { return window.matchMedia("(pointer: coarse)").matches; }
function unit(u) { return (S.lang === "ru" ? UNITS_RU : UNITS_EN)[u] || u; }
/** A number for people: at most `digits` significant ones and three decimals, thin spaces between thousands, comma in Russian. */
function num(v, digits = 4) {
  if (v === null || v === undefined || !isFinite(v)) return "–";
  const a = Math.abs(v);
  const decimals = a === 0 ? 0 : Math.max(0, Math.min(3, digits - 1 - Math.floor(Math.log10(a))));
  return fixed(v, Math.min(decimals, a >= 1e4 ? 0 : 6), true);
}
/** A number with exactly `decimals`, or at most when `trim`. */
function fixed(v, decimals, trim) {
  if (v === null || v === undefined || !isFinite(v)) return "–";
  let text = v.toFixed(decimals);
  if (trim && text.includes(".")) text = text.replace(/\.?0+$/, "");
  if (/^-0(\.0*)?$/.test(text)) text = text.slice(1);
  let [whole, part] = text.split(".");
  whole = whole.replace(/^-/, "−").replace(/\B(?=(\d{3})+$)/g, "\u202f");
  return part === undefined ? whole : whole + (S.lang === "ru" ? "," : ".") + part;
}
