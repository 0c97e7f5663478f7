## Collects samples of a running hertzline stream: octave_client.m [ENDPOINT [STREAM [SAMPLES [FILE]]]]
pkg load zeromq
words = {"tcp://127.0.0.1:5573", "v_out", "10000", ""};
words(1:numel(argv())) = argv();
[endpoint, stream, samples, file] = words{:};
samples = str2double(samples);

socket = zmq_socket(ZMQ_SUB);
zmq_connect(socket, endpoint);
zmq_setsockopt(socket, ZMQ_SUBSCRIBE, [stream "/raw"]);
v = single([]);
while numel(v) < samples
  topic = zmq_recv(socket, 64);
  frame = zmq_recv(socket, 2^20);  # bytes; what is longer is cut
  if numel(frame) == 2^20
    error("found a frame of 1 MiB or more, allowed: less; output.frame_samples makes them shorter");
  endif
  v = [v, reshape(typecast(frame, "single"), 1, [])];
endwhile
v = v(1:samples);
printf("%d samples of %s, peak %.4g\n", numel(v), stream, max(abs(v)));
if ! isempty(file)
  out = fopen(file, "w");
  fwrite(out, v, "single", 0, "ieee-le");
  fclose(out);
endif
zmq_close(socket);
