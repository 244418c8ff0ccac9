// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/places/places.hpp"
#include "tests/shell/line.hpp"

namespace servogate::shell {
namespace {

TEST(Installed, it_runs_from_its_own_folder_and_finds_the_device_files_beside_it) {
  const Desk desk;
  const std::string install =
      tests::cmake() + " --install " + tests::binary_dir() + " --prefix \"$PWD/there\" > install.log 2>&1";
  ASSERT_EQ(desk.line(install).code, 0) << desk.text("install.log");
  EXPECT_EQ(desk.line("there/bin/servogate check there/share/servogate/examples/mill/machine.toml").code, 0);
  // A device file that only the installed folder has.
  ASSERT_EQ(
      desk.line("cd there/share/servogate && cp devices/servo-cia402.toml devices/only-here.toml && "
                "sed 's/\"servo-cia402\"/\"only-here\"/' examples/mill/machine.toml > ../../../m.toml && "
                "cp examples/mill/mill.st ../../..")
          .code,
      0);
  const Ended e = desk.line("there/bin/servogate check m.toml");
  EXPECT_EQ(e.code, 0) << e.err;
  EXPECT_EQ(desk.line("$SG check m.toml").code, 1) << "found elsewhere";
}

TEST(Installed, it_brings_its_documents_and_leaves_nothing_behind_when_it_is_uninstalled) {
  const Desk desk;
  ASSERT_EQ(
      desk.line("mkdir -p there/bin there/share/man && echo mine > there/bin/another && " + tests::cmake() +
                " --install " + tests::binary_dir() + " --prefix \"$PWD/there\" > install.log 2>&1")
          .code,
      0)
      << desk.text("install.log");
  for (const char* file : {"bin/servogate", "share/man/man1/servogate.1", "share/man/ru/man1/servogate.1",
                           "share/bash-completion/completions/servogate", "share/doc/servogate/README.md",
                           "share/doc/servogate/docs/safety.md", "share/doc/servogate/LICENSE",
                           "share/servogate/machine.schema.json", "share/servogate/devices/servo-cia402.toml",
                           "share/servogate/examples/minimal/machine.toml",
                           "lib/udev/rules.d/70-servogate.rules", "lib/systemd/system/servogate@.service"})
    EXPECT_EQ(desk.line(std::string("test -s there/") + file).code, 0) << file;
  EXPECT_TRUE(desk.line("cat there/lib/systemd/system/servogate@.service")
                  .out_has(desk.path("there/bin/servogate up")));
  EXPECT_TRUE(desk.line("cat there/share/man/ru/man1/servogate.1").out_has("КОМАНДЫ"));
  EXPECT_EQ(desk.line("file=there/bin/servogate; test $(stat -c %s $file) -lt $(stat -c %s $SG)").code, 0)
      << "stripped";
  EXPECT_EQ(desk.line("sh there/share/servogate/uninstall").code, 0);
  EXPECT_EQ(desk.line("find there -type f").out, "there/bin/another\n");
  EXPECT_EQ(desk.line("find there -name 'servogate*'").out, "");
}

TEST(Manual, of_all_commands_is_a_page_without_a_mistake_in_both_languages) {
  const Desk desk;
  for (const char* language : {"C", "ru_RU.UTF-8"}) {
    const Ended page = desk.line("LC_ALL=" + std::string(language) +
                                 " $SG man > p.1 && groff -man -Kutf8 -Tutf8 -ww p.1 | col -bx");
    EXPECT_EQ(page.err, "") << language;
    for (const char* part :
         {"servogate run", "servogate can restart", "--realtime[=best-effort]", "plc watch"})
      EXPECT_TRUE(page.out_has(part)) << part << ", " << language;
  }
}

TEST(Completion, offers_commands_options_and_their_words_and_leaves_files_to_the_shell) {
  const Desk desk;
  const auto offered = [&](const std::string& words, int at) {
    const Ended e =
        desk.line("PATH=$(dirname $SG):$PATH bash -c 'source <($0 completion bash); COMP_WORDS=(" + words +
                  "); COMP_CWORD=" + std::to_string(at) + "; _servogate; echo \"${COMPREPLY[@]}\"' $SG");
    EXPECT_EQ(e.err, "");
    return e.out;
  };
  EXPECT_EQ(offered("servogate re", 1), "resume return retrace reset replay restore\n");
  EXPECT_EQ(offered("servogate can \"\"", 2), "bus check restart --help\n");
  EXPECT_EQ(offered("servogate can bus --li", 3), "--listen\n");
  EXPECT_EQ(offered("servogate run m.toml --v", 3), "--virtual\n");
  EXPECT_EQ(offered("servogate run m.toml --realtime = b", 5), "best-effort\n");
  EXPECT_EQ(offered("servogate play b f --from \"\"", 5), "master devices\n");
  EXPECT_EQ(offered("servogate run ex", 2), "\n") << "a file: the shell's own completion";
  EXPECT_EQ(offered("servogate run m.toml --trace m", 4), "\n");
  EXPECT_EQ(desk.line("$SG completion fish").code, 2);
}

TEST(RealTime, that_is_refused_names_the_program_itself_in_the_command_that_grants_it) {
  const Desk desk;
  // Also where the tests run as root, who has the rights otherwise.
  const Ended e = desk.line(
      "mkdir 'a b'; cp $SG 'a b/servogate'; ulimit -r 0; "
      "if [ $(id -u) = 0 ]; then without='setpriv --bounding-set=-sys_nice,-ipc_lock'; fi; "
      "$without 'a b/servogate' run $MILL --realtime -q");
  EXPECT_EQ(e.code, 4) << e.err;
  EXPECT_TRUE(e.err_has("sudo setcap cap_sys_nice,cap_ipc_lock=ep '" + desk.path("a b/servogate'"))) << e.err;
}

}  // namespace
}  // namespace servogate::shell
