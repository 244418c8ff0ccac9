// SPDX-License-Identifier: Apache-2.0
#include <openssl/evp.h>
#include <sys/utsname.h>
#include <filesystem>

#include <fstream>
#include <memory>
#include <thread>

#include "report/report.hpp"

namespace servogate::report {

namespace {

/// SHA-256 of FIPS 180-4, by libcrypto.
class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
  }
  void add(const char* data, std::size_t size) { EVP_DigestUpdate(context_.get(), data, size); }
  std::string hex() {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned int size = 0;
    EVP_DigestFinal_ex(context_.get(), digest, &size);
    std::string out;
    for (unsigned int i = 0; i < size; ++i) {
      out += "0123456789abcdef"[digest[i] >> 4];
      out += "0123456789abcdef"[digest[i] & 15];
    }
    return out;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

/// "model name" of x86, "Model" of many Arm boards; else the machine type alone.
std::string processor_name(const std::string& machine) {
  std::ifstream file("/proc/cpuinfo");
  std::string model;
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || colon + 2 > line.size()) continue;
    if (line.starts_with("model name") || line.starts_with("Model")) model = line.substr(colon + 2);
    if (!model.empty()) break;
  }
  const std::string cores = std::to_string(std::thread::hardware_concurrency()) + " cores";
  return model.empty() ? machine + ", " + cores : model + " (" + machine + "), " + cores;
}

}  // namespace

std::string sha256(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

std::optional<std::string> sha256_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  Sha256 hash;
  char buffer[16384];
  while (file.read(buffer, sizeof buffer) || file.gcount() > 0)
    hash.add(buffer, static_cast<std::size_t>(file.gcount()));
  if (file.bad() || !file.eof()) return std::nullopt;
  return hash.hex();
}

FileIdentity identify(const std::string& path) {
  std::error_code error;  // a device has no end, a pipe may have no writer
  if (!std::filesystem::is_regular_file(path, error)) return {path, ""};
  return {path, sha256_of_file(path).value_or("")};
}

void fill_host(Provenance& p) {
  p.version = build_identity().version;
  p.commit = build_identity().commit;
  utsname host{};
  if (uname(&host) != 0) return;
  p.kernel = std::string(host.sysname) + " " + host.release + " " + host.version;
  p.processor = processor_name(host.machine);
}

}  // namespace servogate::report
