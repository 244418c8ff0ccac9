// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/text/system_words.hpp"

#include <cerrno>
#include <string_view>
#include <system_error>

#include "firmware_if/text/finding.hpp"

namespace servogate::text {

namespace {

/// The English ones are the system's, which people know and search for.
constexpr struct {
  int error;
  std::string_view russian;
} kRussian[] = {{ENOENT, "нет такого файла или каталога"},
                {EACCES, "доступ запрещён"},
                {EPERM, "операция не разрешена"},
                {EISDIR, "это каталог"},
                {ENOTDIR, "это не каталог"},
                {EEXIST, "файл уже существует"},
                {ENOTEMPTY, "каталог не пуст"},
                {ENOSPC, "на носителе нет места"},
                {EDQUOT, "исчерпана квота на носителе"},
                {EROFS, "носитель только для чтения"},
                {EFBIG, "файл слишком велик"},
                {EXDEV, "файлы лежат на разных носителях"},
                {ETXTBSY, "программа в этом файле сейчас выполняется"},
                {EIO, "ошибка ввода-вывода"},
                {EBADF, "поток закрыт"},
                {EPIPE, "читающая сторона закрыта"},
                {ENAMETOOLONG, "слишком длинное имя"},
                {ELOOP, "слишком много символических ссылок"},
                {EMFILE, "открыто слишком много файлов"},
                {ENFILE, "в системе открыто слишком много файлов"},
                {ENOMEM, "не хватает памяти"},
                {EAGAIN, "ресурс временно недоступен"},
                {EBUSY, "занято другим"},
                {EINVAL, "недопустимое значение"},
                {ERANGE, "значение вне допустимых пределов"},
                {EOPNOTSUPP, "не поддерживается"},
                {ETIMEDOUT, "время ожидания истекло"},
                {ENXIO, "за этим именем нет устройства"},
                {ENODEV, "нет такого устройства"},
                {ENETDOWN, "сеть выключена"},
                {ENETUNREACH, "сеть недоступна"},
                {EHOSTUNREACH, "до этого компьютера нет пути"},
                {EADDRINUSE, "адрес уже занят"},
                {EADDRNOTAVAIL, "у этого компьютера нет такого адреса"},
                {EAFNOSUPPORT, "система не поддерживает это семейство адресов"},
                {EPROTONOSUPPORT, "система не поддерживает этот протокол"},
                {ENOBUFS, "в системе не осталось буферов"},
                {ECONNREFUSED, "соединение отклонено"},
                {ECONNRESET, "соединение разорвано другой стороной"}};

}  // namespace

std::string words_of(int error) {
  // Not strerror(), whose answer another thread may overwrite.
  const std::string english = std::generic_category().message(error);
  for (const auto& row : kRussian)
    if (row.error == error) return both(english, row.russian);
  return english;
}

}  // namespace servogate::text
