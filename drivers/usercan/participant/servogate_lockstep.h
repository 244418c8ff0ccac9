/* SPDX-License-Identifier: Apache-2.0 */
/* Lets a C program take part in a servogate bus in lockstep: `servogate can bus can0 --lockstep N` grants time, this
 * program answers when it is done with it. One file, POSIX sockets, nothing else. See docs/can.md.
 *
 *   struct servogate_bus bus;
 *   struct servogate_frame frame;
 *   int64_t now;
 *   if (servogate_open(&bus, "127.0.0.1", 29536, "can0", "my-device") != 0) return 1;
 *   while (servogate_wait(&bus, &now) == 0) {
 *     while (servogate_receive(&bus, &frame) == 0) { ... }
 *     ... servogate_send(&bus, &frame) ...
 *     servogate_done(&bus, now + 1000000);   // wake me in a millisecond, or when a frame has ended
 *   }
 *   servogate_close(&bus);
 *
 * All functions return 0 when they succeeded. Times are nanoseconds since the beginning.
 */
#ifndef SERVOGATE_LOCKSTEP_H
#define SERVOGATE_LOCKSTEP_H

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct servogate_frame {
  uint32_t id;
  uint8_t extended; /* 29-bit identifier */
  uint8_t remote;
  uint8_t length; /* 0-8 */
  uint8_t data[8];
};

struct servogate_bus {
  int socket;
  int64_t now;
  size_t begin, end;   /* what has come and was not looked at yet */
  size_t heard;        /* frames before this place count at `now` */
  size_t out_size;     /* sent with servogate_done() */
  char in[1 << 16];
  char out[1 << 16];
};

/* Next element "< ... >" behind `from`; its words without the brackets, 0-terminated in `text`. 0: none complete. */
static inline size_t servogate_element(const struct servogate_bus* bus, size_t from, char* text, size_t size) {
  size_t begin = from, end, n = 0;
  while (begin < bus->end && bus->in[begin] != '<') ++begin;
  for (end = begin; end < bus->end && bus->in[end] != '>';) ++end;
  if (end >= bus->end) return 0;
  for (++begin; begin < end && n + 1 < size; ++begin) text[n++] = bus->in[begin];
  text[n] = 0;
  return end + 1;
}

static inline int servogate_flush(struct servogate_bus* bus) {
  size_t done = 0;
  while (done < bus->out_size) {
    ssize_t n = send(bus->socket, bus->out + done, bus->out_size - done, MSG_NOSIGNAL);
    if (n <= 0) return -1;
    done += (size_t)n;
  }
  bus->out_size = 0;
  return 0;
}

static inline int servogate_say(struct servogate_bus* bus, const char* text) {
  size_t size = strlen(text);
  if (size > sizeof bus->out - bus->out_size && servogate_flush(bus) != 0) return -1;
  memcpy(bus->out + bus->out_size, text, size);
  bus->out_size += size;
  return 0;
}

/* Reads more. Blocks. */
static inline int servogate_fill(struct servogate_bus* bus) {
  ssize_t n;
  memmove(bus->in, bus->in + bus->begin, bus->end - bus->begin);
  bus->end -= bus->begin;
  bus->begin = 0;
  if (bus->end == sizeof bus->in) return -1;
  n = recv(bus->socket, bus->in + bus->end, sizeof bus->in - bus->end, 0);
  if (n <= 0) return -1;
  bus->end += (size_t)n;
  return 0;
}

static inline int servogate_expect(struct servogate_bus* bus, const char* say, const char* answer) {
  char text[256], word[32];
  size_t next;
  if (servogate_say(bus, say) != 0 || servogate_flush(bus) != 0) return -1;
  for (;;) {
    while ((next = servogate_element(bus, bus->begin, text, sizeof text)) != 0) {
      bus->begin = next;
      if (sscanf(text, "%31s", word) != 1) continue;
      if (strcmp(word, answer) == 0) return 0;
      if (strcmp(word, "error") == 0) {
        fprintf(stderr, "bus server: %s\n", text);
        return -1;
      }
    }
    if (servogate_fill(bus) != 0) return -1;
  }
}

static inline int servogate_open(struct servogate_bus* bus, const char* address, uint16_t port, const char* name,
                                 const char* participant) {
  struct sockaddr_in server;
  char text[256];
  int on = 1;
  memset(bus, 0, sizeof *bus);
  memset(&server, 0, sizeof server);
  server.sin_family = AF_INET;
  server.sin_port = htons(port);
  if (inet_pton(AF_INET, address, &server.sin_addr) != 1) return -1;
  bus->socket = socket(AF_INET, SOCK_STREAM, 0);
  if (bus->socket < 0 || connect(bus->socket, (struct sockaddr*)&server, sizeof server) != 0) return -1;
  setsockopt(bus->socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (servogate_expect(bus, "", "hi") != 0) return -1;
  snprintf(text, sizeof text, "< open %s >", name);
  if (servogate_expect(bus, text, "ok") != 0 || servogate_expect(bus, "< rawmode >", "ok") != 0 ||
      servogate_expect(bus, "< remotemode >", "ok") != 0)
    return -1;
  snprintf(text, sizeof text, "< lockstep %s >", participant);
  return servogate_expect(bus, text, "ok");
}

/* Waits for the next grant of time. Not 0: time has ended. */
static inline int servogate_wait(struct servogate_bus* bus, int64_t* now) {
  char text[256];
  if (bus->begin < bus->heard) bus->begin = bus->heard;
  for (;;) {
    size_t at = bus->begin, next;
    while ((next = servogate_element(bus, at, text, sizeof text)) != 0) {
      long long t;
      at = next;
      if (strncmp(text, " end", 4) == 0) return 1;
      if (sscanf(text, " grant %lld", &t) != 1) continue;
      bus->now = *now = t;
      bus->heard = at;
      return 0;
    }
    bus->heard = 0;
    if (servogate_fill(bus) != 0) return -1;
  }
}

/* Takes a frame that has ended until now. Not 0: none is left. */
static inline int servogate_receive(struct servogate_bus* bus, struct servogate_frame* frame) {
  char text[256], word[16], id[16], rest[64];
  while (bus->begin < bus->heard) {
    size_t next = servogate_element(bus, bus->begin, text, sizeof text), i;
    int words;
    if (next == 0) return 1;
    bus->begin = next;
    rest[0] = 0;
    words = sscanf(text, " %15s %15s %*s %63s", word, id, rest);
    if (words < 2 || (strcmp(word, "frame") != 0 && strcmp(word, "remote") != 0)) continue;
    memset(frame, 0, sizeof *frame);
    frame->id = (uint32_t)strtoul(id, NULL, 16);
    frame->extended = strlen(id) == 8;
    frame->remote = word[0] == 'r';
    if (frame->remote) {
      frame->length = (uint8_t)strtoul(rest, NULL, 16);
      return 0;
    }
    for (i = 0; i < 8 && rest[2 * i] != 0 && rest[2 * i + 1] != 0; ++i) {
      char byte[3] = {rest[2 * i], rest[2 * i + 1], 0};
      frame->data[frame->length++] = (uint8_t)strtoul(byte, NULL, 16);
    }
    return 0;
  }
  return 1;
}

/* Sends a frame: it takes part in the arbitration at this instant. */
static inline int servogate_send(struct servogate_bus* bus, const struct servogate_frame* frame) {
  char text[128];
  int n = snprintf(text, sizeof text, frame->extended ? "< %s %08X %X" : "< %s %03X %X",
                   frame->remote ? "remote" : "send", (unsigned)frame->id, (unsigned)frame->length);
  int i;
  for (i = 0; i < frame->length && i < 8 && !frame->remote; ++i)
    n += snprintf(text + n, sizeof text - (size_t)n, " %02X", frame->data[i]);
  snprintf(text + n, sizeof text - (size_t)n, " >");
  return servogate_say(bus, text);
}

/* Done with this instant; time is wanted again at `wish`, or when a frame has ended, whichever is earlier. */
static inline int servogate_done(struct servogate_bus* bus, int64_t wish) {
  char text[96];
  snprintf(text, sizeof text, "< done %lld %lld >", (long long)bus->now, (long long)wish);
  return servogate_say(bus, text) != 0 ? -1 : servogate_flush(bus);
}

static inline void servogate_close(struct servogate_bus* bus) { close(bus->socket); }

#endif
