"""Where the sun is, by PyEphem (XEphem's library: VSOP87, FK5, nutation, parallax), for places and dates all over.

    python3 tests/features/time/sun.py > tests/features/time/sun.txt

A line has the latitude and the longitude in degrees, a date-time in UTC, and the sun's azimuth (clockwise from true north) and elevation without
refraction, degrees.
"""

import math

import ephem

PLACES = [
    ("Delft", 52.0116, 4.3571), ("Wien", 48.2082, 16.3738), ("Lyon", 45.7640, 4.8357), ("Reykjavik", 64.1466, -21.9426),
    ("Tromso", 69.6492, 18.9553), ("New York", 40.7128, -74.0060), ("San Francisco", 37.7749, -122.4194), ("Mexico", 19.4326, -99.1332),
    ("Quito", -0.1807, -78.4678), ("Lima", -12.0464, -77.0428), ("Sao Paulo", -23.5505, -46.6333), ("Ushuaia", -54.8019, -68.3030),
    ("Cape Town", -33.9249, 18.4241), ("Nairobi", -1.2921, 36.8219), ("Cairo", 30.0444, 31.2357), ("Mumbai", 19.0760, 72.8777),
    ("Singapore", 1.3521, 103.8198), ("Tokyo", 35.6762, 139.6503), ("Sydney", -33.8688, 151.2093), ("Suva", -18.1248, 178.4501),
]
DATES = ["2026-06-21 12:00:00", "2025-03-20 09:01:00", "1999-08-11 10:23:00", "2030-12-21 15:30:00", "1950-10-05 06:45:30", "1900-02-28 18:00:00",
         "2024-02-29 03:15:00", "1969-07-20 20:17:40"]

for number, (name, latitude, longitude) in enumerate(PLACES):
    for k in range(2):
        date = DATES[(number + 3 * k) % len(DATES)]
        observer = ephem.Observer()
        observer.lat, observer.lon = math.radians(latitude), math.radians(longitude)
        observer.elevation, observer.pressure, observer.date = 0, 0, date.replace("-", "/")
        sun = ephem.Sun(observer)
        print(latitude, longitude, date.replace(" ", "T"), f"{math.degrees(sun.az):.4f}", f"{math.degrees(sun.alt):.4f}", name)
