/* SPDX-License-Identifier: Apache-2.0 */
/* Somebody's own firmware on a bus in lockstep: answers every SYNC with a counter and the instant it saw, and sends a
 * heartbeat every 10 ms. Usage: lockstep_participant PORT NODE */
#include "servogate_lockstep.h"

int main(int argc, char** argv) {
  static struct servogate_bus bus;
  struct servogate_frame frame;
  int64_t now = 0, heartbeat = 0;
  uint32_t count = 0, node;
  char name[32];
  if (argc != 3) return 2;
  node = (uint32_t)atoi(argv[2]);
  snprintf(name, sizeof name, "node-%u", (unsigned)node);
  if (servogate_open(&bus, "127.0.0.1", (uint16_t)atoi(argv[1]), "can0", name) != 0) return 1;
  while (servogate_wait(&bus, &now) == 0) {
    while (servogate_receive(&bus, &frame) == 0) {
      struct servogate_frame answer = {0x180 + node, 0, 0, 8, {0}};
      uint32_t microseconds = (uint32_t)(now / 1000);
      if (frame.id != 0x080 || frame.remote || frame.extended) continue;
      ++count;
      memcpy(answer.data, &count, 4);
      memcpy(answer.data + 4, &microseconds, 4);
      servogate_send(&bus, &answer);
    }
    if (now >= heartbeat) {
      struct servogate_frame alive = {0x700 + node, 0, 0, 1, {5}};
      servogate_send(&bus, &alive);
      heartbeat += 10000000;
    }
    servogate_done(&bus, heartbeat);
  }
  servogate_close(&bus);
  return count > 0 ? 0 : 3;
}
