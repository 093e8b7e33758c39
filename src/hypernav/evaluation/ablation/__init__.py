"""Ablation: one data set, many variants of a method, each compared with the unchanged one."""
