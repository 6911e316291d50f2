"""Dropflow on one machine without Docker: its servers, its processes and the demo, started by one command.

settings      what the environment says: PORT, DATA, DATABASE_URL, REDIS_URL
accounts      as whom a server runs when we are root
processes     one child process: how it starts, dies and is found again after a crash
postgres      PostgreSQL on a folder            valkey      Valkey (or Redis) on a folder
keys          passwords made once for a folder  folder      the folder of one instance, and its lock
services      the commands of API and workers   supervisor  starts all in order, restarts, stops in order
demo          a small simulated experiment, sent through the public API
"""
