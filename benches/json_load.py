"""The reference of the loading bench: for every path on stdin, seconds that json.load takes with the collector off.

CityJSONSeq is read line by line with json.loads. The file is in the page cache: the bench has just read it.
"""

import gc
import gzip
import json
import sys
import time

gc.disable()
for path in map(str.strip, sys.stdin):
    start = time.perf_counter()
    opener = gzip.open if path.endswith(".gz") else open
    with opener(path, "rt", encoding="utf-8-sig") as file:
        if ".jsonl" in path:
            data = [json.loads(line) for line in file if line.strip()]
        else:
            data = json.load(file)
    seconds = time.perf_counter() - start
    # Freeing is not part of loading.
    del data
    print(seconds, flush=True)
