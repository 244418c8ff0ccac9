// SPDX-License-Identifier: Apache-2.0
#include "gateway/files/system_words.hpp"

#include <cerrno>
#include <cstring>
#include <string_view>

#include "firmware_if/text/finding.hpp"

namespace servogate::files {

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
                {ENOSPC, "на носителе нет места"},
                {EDQUOT, "исчерпана квота на носителе"},
                {EROFS, "носитель только для чтения"},
                {EFBIG, "файл слишком велик"},
                {EIO, "ошибка ввода-вывода"},
                {EBADF, "поток закрыт"},
                {ENAMETOOLONG, "слишком длинное имя"},
                {ELOOP, "слишком много символических ссылок"},
                {EMFILE, "открыто слишком много файлов"},
                {ENXIO, "за этим именем нет устройства"},
                {ENOMEM, "не хватает памяти"},
                {EADDRINUSE, "адрес уже занят"},
                {ECONNREFUSED, "соединение отклонено"}};

}  // namespace

std::string words_of(int error) {
  for (const auto& row : kRussian)
    if (row.error == error) return text::both(std::strerror(error), row.russian);
  return std::strerror(error);
}

}  // namespace servogate::files
