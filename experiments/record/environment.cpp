#include "experiments/record/environment.h"

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <optional>
#include <sstream>

#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <fmt/format.h>
#include <hwloc.h>
#include <raymeter_build_info.h>
#include <nlohmann/json.hpp>

#include "core/simd/isa.h"

namespace raymeter {

namespace {

using Json = nlohmann::ordered_json;

std::optional<std::string> first_line(const char* path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  return line;
}

Json line_or_null(const char* path) {
  const std::optional<std::string> line = first_line(path);
  return line ? Json(*line) : Json(nullptr);
}

/// The value of the first "KEY : value" line of /proc/cpuinfo or the like.
std::string keyed_value(const char* path, std::string_view key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t value = line.find_first_not_of(" \t", line.find(':') + 1);
    return value == std::string::npos ? std::string() : line.substr(value);
  }
  return {};
}

std::string host_name() {
  char name[256] = {};
  return ::gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

std::string cpu_model() {
  const std::string model = keyed_value("/proc/cpuinfo", "model name");
  return model.empty() ? "unknown" : model;
}

bool virtual_machine() { return keyed_value("/proc/cpuinfo", "flags").find("hypervisor") != std::string::npos; }

int usable_cpus() {
  cpu_set_t set;
  return ::sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 0;
}

/// Cores, threads, caches and memory, from hwloc.
Json topology() {
  hwloc_topology_t topology = nullptr;
  hwloc_topology_init(&topology);
  hwloc_topology_load(topology);
  const auto count = [&](hwloc_obj_type_t type) { return hwloc_get_nbobjs_by_type(topology, type); };
  Json json{{"packages", count(HWLOC_OBJ_PACKAGE)},
            {"cores", count(HWLOC_OBJ_CORE)},
            {"hardware_threads", count(HWLOC_OBJ_PU)},
            {"numa_nodes", count(HWLOC_OBJ_NUMANODE)}};
  Json caches = Json::array();
  const std::pair<const char*, hwloc_obj_type_t> kinds[]{
      {"L1d", HWLOC_OBJ_L1CACHE}, {"L1i", HWLOC_OBJ_L1ICACHE}, {"L2", HWLOC_OBJ_L2CACHE}, {"L3", HWLOC_OBJ_L3CACHE}};
  for (const auto& [name, type] : kinds) {
    const hwloc_obj_t cache = hwloc_get_obj_by_type(topology, type, 0);
    if (cache == nullptr) continue;
    caches.push_back({{"name", name}, {"count", count(type)}, {"bytes", cache->attr->cache.size}, {"line_bytes", cache->attr->cache.linesize}});
  }
  json["caches"] = caches;
  json["memory_bytes"] = hwloc_get_root_obj(topology)->total_memory;
  hwloc_topology_destroy(topology);
  return json;
}

Json turbo() {
  if (const auto off = first_line("/sys/devices/system/cpu/intel_pstate/no_turbo")) return *off == "0";
  if (const auto on = first_line("/sys/devices/system/cpu/cpufreq/boost")) return *on == "1";
  return nullptr;
}

Json smt() {
  const auto active = first_line("/sys/devices/system/cpu/smt/active");
  return active ? Json(*active == "1") : Json(nullptr);
}

Json load_average() {
  double load[3];
  return ::getloadavg(load, 3) == 3 ? Json{load[0], load[1], load[2]} : Json(nullptr);
}

Json build_json() {
  return {{"git_sha", build_info::kGitSha},
          {"git_dirty", build_info::kGitDirty},
          {"compiler", build_info::kCompiler},
          {"build_type", build_info::kBuildType},
          {"flags", build_info::kFlags}};
}

Json environment() {
  Json isas = Json::array();
  for (const Isa isa : kIsas) {
    if (available(isa)) isas.push_back(name(isa));
  }
  utsname system{};
  ::uname(&system);
  Json cpu{{"model", cpu_model()},
           {"microcode", keyed_value("/proc/cpuinfo", "microcode")},
           {"isas", isas},
           {"best_isa", name(best_isa())},
           {"usable", usable_cpus()},
           {"virtual_machine", virtual_machine()}};
  cpu.update(topology());
  Json frequency{{"governor", line_or_null("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")}, {"turbo", turbo()}, {"smt", smt()}};
  Json os{{"kernel", fmt::format("{} {} {}", system.sysname, system.release, system.version)},
          {"machine", system.machine},
          {"aslr", line_or_null("/proc/sys/kernel/randomize_va_space")},
          {"transparent_hugepages", line_or_null("/sys/kernel/mm/transparent_hugepage/enabled")},
          {"load_average", load_average()}};
  return {{"utc", utc_stamp()}, {"host", host_name()}, {"cpu", cpu}, {"frequency", frequency}, {"os", os}, {"build", build_json()}};
}

void add_lines(const Json& json, const std::string& prefix, std::string& text) {
  for (const auto& [key, value] : json.items()) {
    if (value.is_object())
      add_lines(value, prefix + key + ".", text);
    else
      text += fmt::format("{:<28} {}\n", prefix + key, value.is_string() ? value.get<std::string>() : value.is_null() ? "unknown" : value.dump());
  }
}

}  // namespace

Fingerprint fingerprint() {
  return {host_name(), cpu_model(), build_info::kGitSha, build_info::kGitDirty, std::string_view(build_info::kBuildType) == "Release"};
}

std::string environment_json() { return environment().dump(2) + "\n"; }

std::string environment_text() {
  std::string text;
  add_lines(environment(), "", text);
  return text;
}

std::vector<std::string> noise_sources() {
  std::vector<std::string> found;
  if (std::string_view(build_info::kBuildType) != "Release") found.push_back(fmt::format("the build is {}, not Release", build_info::kBuildType));
  if (build_info::kGitDirty) found.emplace_back("the build has uncommitted changes");
  const auto governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  if (governor && *governor != "performance") found.push_back(fmt::format("the CPU frequency governor is {}, not performance", *governor));
  if (turbo() == Json(true)) found.emplace_back("turbo is on: the clock depends on heat and on how many cores work");
  if (smt() == Json(true)) found.emplace_back("SMT is on: hardware threads share cores");
  if (virtual_machine()) found.emplace_back("this is a virtual machine: neighbours may take time unseen");
  double load[1];
  if (::getloadavg(load, 1) == 1 && load[0] > 0.2) found.push_back(fmt::format("the load average is {:.2f}: other programs are running", load[0]));
  return found;
}

std::string utc_stamp() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", &utc);
  return text;
}

}  // namespace raymeter
