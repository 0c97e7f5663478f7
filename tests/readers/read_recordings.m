% Reads recordings with Octave's own functions and compares each number: octave-cli read_recordings.m FOLDER
% Octave has no reader for .npy.
folder = argv(){1};

function numbers = raw(file, type)
  handle = fopen(file);
  numbers = fread(handle, Inf, ["*" type]);
  fclose(handle);
end

function same(name, a, b)
  assert(class(a), class(b));
  assert(isequal(a, b), name);
end

for name = {"narrow", "exact"}
  file = fullfile(folder, name{1});
  values = reshape(raw([file ".values"], "double"), 8, [])';
  if strcmp(name{1}, "narrow")
    values = single(values);
    [samples, rate] = audioread([file ".wav"], "native");
    same("wav", samples, values);
    assert(rate, 10e6);
    handle = fopen([file ".sigmf-data"], "r", "ieee-le");
    sigmf = fread(handle, [8, Inf], "*single")';
    fclose(handle);
    same("sigmf", sigmf, values);
  end
  csv = dlmread([file ".csv"], ",", 1, 0);
  same("csv", csv(:, 2:end), double(values));
  same("t_s", csv(:, 1), double(raw([file ".samples"], "int64")) / 10e6);
  h = load("-hdf5", [file ".h5"]);  % the last dimension comes first: [sphere][sample]
  same("v_last", double(h.v_last(:)), double(values(:, 1)));
  same("v_out", double(h.v_out(:)), double(values(:, 2)));
  same("x_chain", double(h.x_chain), double(values(:, 3:2:end)'));
  same("v_chain", double(h.v_chain), double(values(:, 4:2:end)'));
  assert(double(h.captures), [0 1000; 3 5000]);
  printf("%s: %d numbers, each the same\n", name{1}, numel(values));
end
